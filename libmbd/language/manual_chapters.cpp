#include "libmbd/language/manual_chapters.hpp"

namespace mbd::manual {
namespace {

// ---- words of expressions (libmbd/core/expression.hpp) ----------------------------------------

constexpr Word function_words[] = {
    {"sin", "x", "sine of an angle in rad"},
    {"cos", "x", "cosine of an angle in rad"},
    {"tan", "x", "tangent of an angle in rad"},
    {"asin", "x", "inverse sine [rad]"},
    {"acos", "x", "inverse cosine [rad]"},
    {"atan", "x", "inverse tangent [rad]"},
    {"atan2", "y, x", "angle of the point (x, y) from the x axis [rad]"},
    {"sinh", "x", "hyperbolic sine"},
    {"cosh", "x", "hyperbolic cosine"},
    {"tanh", "x", "hyperbolic tangent"},
    {"exp", "x", "e to the power x"},
    {"log", "x", "natural logarithm"},
    {"ln", "x", "natural logarithm"},
    {"log10", "x", "logarithm to the base 10"},
    {"sqrt", "x", "square root"},
    {"pow", "x, p", "x^p"},
    {"abs", "x", "magnitude; of t: of a*t + b only"},
    {"min", "x, y", "the smaller one; of t: of a*t + b only"},
    {"max", "x, y", "the greater one; of t: of a*t + b only"},
    {"floor", "x", "the next whole number below; not of t"},
    {"ceil", "x", "the next whole number above; not of t"},
    {"round", "x", "the nearest whole number; not of t"},
};

constexpr Word constant_words[] = {
    {"pi", "", "3.14159…"},
    {"deg", "", "pi/180: `5*deg` is an angle in rad"},
};

// ---- chapters ---------------------------------------------------------------------------------

constexpr std::string_view opening_text =
    R"md(A model is an XML file with one element, `<mbd>`. What stands in it is what is simulated: no
`<gravity>`, no gravity; no `<transient>`, no motion in time. Names may be used before they are
given; parameters and defaults hold for what comes after them. Comments are written `<!-- … -->`.

`mbd check MODEL` reads a model and says what it has; `mbd run MODEL` simulates it.
`mbd schema ELEMENT` prints the page of one element, `mbd schema --xsd` a grammar for XML editors:
put it beside the model as `mbd.xsd` and write

    <mbd name="…" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
         xsi:noNamespaceSchemaLocation="mbd.xsd">

and the editor offers elements, attributes and their meaning. (It insists on names, places and
positions; other required attributes may come from `<defaults>`, which only `mbd check` knows.)
)md";

constexpr Chapter all_chapters[] = {
    {"Numbers are expressions",
     R"md(Wherever a number stands, an expression may: `0.12`, `2*L/3`, `5*deg`, `N > 1 ? 0.5 : 1`. It may use
the parameters above it in the file. An attribute of several numbers has them separated by blanks
(`from="0 0 L/2"`), so that each of them contains no blanks.

Loads, drives and motions are expressions of the time `t` [s] too; `<distributed>` loads also of
`s`, the fraction of the beam's length, 0 at its start and 1 at its end.

| operators, loosest first | meaning |
|---|---|
| `condition ? a : b` | a if the condition holds, else b |
| `\|\|`, `&&`, `!` | or, and, not |
| `<` `<=` `>` `>=` `==` `!=` | comparison of two numbers |
| `+` `-`, then `*` `/` | sum, difference, product, quotient |
| `^` | power: `-2^2` is -4, `2^3^2` is 2^9 |

Numbers (of attributes; not those within laws) are 0 or of a size from 1e-60 to 1e60, so that their products are numbers too.

In XML, `<` and `&` inside an attribute are written `&lt;` and `&amp;`; `1 > t` says the same as
`t < 1`.

A condition of `t` compares terms `a*t + b`, so that the instant when it switches is known: time
steps land on it, and start afresh where a load jumps. Rates, where a law gives an angle or a
displacement, are exact derivatives; where it gives a rate, the angle is its integral to round-off.

The words that expressions know; all others are parameters of the model:

)md",
     true},
    {"Units",
     R"md(Numbers are in SI units and radians, or in the unit written after them: `step="5 ms"`,
`angle="90 deg"`, `force="0 0 -10*t kN"`. A unit after the last of several numbers belongs to all of
them: `from="0 120 0 mm"`. A unit may also stand at once behind a literal number, and then belongs
to that one: `to="120mm 0 1m"`.

A unit is converted to that of its attribute; one of another quantity is refused (`angle="5 mm"`),
and so is one on a pure number. Angles are a quantity of their own: `rate="50 rpm"` is accepted and
`rate="50 Hz"` is refused, because it could mean 50 or 314 rad/s. The values of `<parameter>` and
`<expect>` take all usual units and are converted to SI units and rad. Expressions know only numbers: a
parameter given as `value="6000 mm"` is 6 from then on, so `to="L 0 0"` takes it, `to="L 0 0 mm"` is
refused, and `--set L="5000 mm"` needs a unit too.

Names, prefixes and products are those of UDUNITS-2:

| quantity | for instance |
|---|---|
| length | `m`, `mm`, `um`, `in`, `ft` |
| mass | `kg`, `g`, `t`, `lb` |
| time | `s`, `ms`, `min`, `h` |
| angle; rate of turning | `rad`, `deg`, `rev`, `arcmin`; `rpm`, `deg/s`, `rev/min` |
| force, moment | `N`, `kN`, `lbf`; `N.m`, `kN.mm` |
| others | `kg/m`, `g.mm2`, `N.mm2`, `m/s2`, `kW`, `GPa` |
)md"},
    {"Parameters and --set",
     R"md(`<parameter name="L" value="0.12"/>` names a number for the expressions below it.
`mbd run MODEL --set L=0.2 --set step=5ms` replaces values, as often as needed; the value may be an
expression of the parameters above. Only parameters can be set, so make one of each number that is
to be varied.
)md"},
    {"Names and places",
     R"md(Names are made of letters, digits, `_` and `-`. Beams and bodies share theirs, because places do:

| place | what it is |
|---|---|
| `ground` | the inertial frame |
| `rotor` | the reference point of the body `rotor` |
| `shaft.start`, `shaft.end` | the ends of the beam `shaft` |
| `shaft@0.25` | a quarter of its length from its start |

In names and places, an expression in braces becomes the whole number it is worth: `rod{i+1}.end`.

Inertial axes are i1 i2 i3. Those of a beam's section are b1 b2 b3: b1 along the beam, b3 the part
of `normal` across it, b2 = b3 x b1. Those of a free body are the inertial ones at the start unless
`orientation` turns them. The third axis of a joint is its `axis`. Where the tables say "inertial
axes", "section axes" or "body axes", they mean these.
)md"},
    {"Repetition",
     R"md(`<repeat count="n">` reads what stands in it n times. Its `index` (`i` unless it says otherwise) is
a parameter that counts from 0: `at="i*0.5 0 0"`, `name="rod{i+1}"`. Repetitions may be nested, each
with its own index.
)md"},
    {"Defaults",
     R"md(`<defaults>` gives attributes that later elements of a kind have when they do not say otherwise.
Later defaults replace earlier ones, attribute by attribute. Names, and places and positions that an
element must have, are its own and do not belong there. A default holds for every later element of
its kind: one that excludes another attribute (`velocity` of a body with `attached_to`) is refused
there.

```xml
<mbd name="portal">
  <defaults>
    <beam section="tube" elements="2" order="4"/>
    <record quantities="displacement rotation"/>
  </defaults>
  <section name="tube">
    <stiffness EA="4e7" GA2="1e7" GA3="1e7" GJ="5e4" EI2="6e4" EI3="6e4"/>
  </section>
  <beam name="left" from="0 0 0" to="0 0 3" normal="1 0 0"/>
  <beam name="top" from="0 0 3" to="4 0 3" normal="0 0 1" elements="4"/>
  <beam name="right" from="4 0 3" to="4 0 0" normal="1 0 0"/>
  <fixed name="A" between="ground left.start"/>
  <fixed name="B" between="left.end top.start"/>
  <fixed name="C" between="top.end right.start"/>
  <fixed name="D" between="right.end ground"/>
  <load at="left.end" force="2 0 0 kN"/>
  <static/>
  <record name="B" at="left.end"/>
  <record name="C" at="right.start"/>
</mbd>
```
)md"},
    {"Includes",
     R"md(`<include file="tubes.xml"/>` reads the elements of another file in its place; the path is relative
to the file that says so. That file is a model too; its own name is not used.

`tubes.xml`:

```xml
<mbd name="tubes">
  <section name="tube40">
    <stiffness EA="2e7" GA2="5e6" GA3="5e6" GJ="8e3" EI2="1e4" EI3="1e4"/>
    <mass per_length="0.8" inertia="8e-4 4e-4 4e-4"/>
  </section>
</mbd>
```

`springboard.xml`:

```xml
<mbd name="springboard">
  <include file="tubes.xml"/>
  <beam name="board" section="tube40" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
  <fixed name="wall" between="ground board.start"/>
  <load at="board.end" force="0 0 0.01>t?-200:0 N"/>
  <transient duration="50 ms" step="0.5 ms"/>
  <record name="tip" at="board.end" quantities="displacement"/>
</mbd>
```
)md"},
    {"What is not there, and what does instead",
     R"md(- **Contact** between bodies or surfaces: not there. A point that meets a wall, a floor or a stop along a known
  direction: a spring or joint spring whose law pushes on one side only (`force="x < 0 ? 1e6*x : 0"`); stiff
  enough that it gives by no more than you allow, with damping so that it does not bounce for ever.
- **End stops** and limits of a joint: a `<joint_spring>` whose law begins at the limit.
- **Dry friction**: `damping_moment="T*tanh(v/v0)"` of a `<joint_spring>` or `damping_force` of a `<spring>`, with
  a friction T that is given. It creeps instead of sticking, at less than v0; the force between the
  surfaces is not taken into account.
- **Control** beyond the laws of sensors and the sampled `<controller>`s of its chapter: continuous integrators and filters
  have no states of their own (a controller with a short `period` has them); sensors cannot steer what a `<drive>` or `<motion>`
  prescribes (a `<joint_torque>` of sensors can). Everything else is for a program (C++ or Python) that steps the model, reads
  what its records say and sets its `<input>`s.
- **Gears, racks, belts, cams, rolling wheels**: not there. A ratio between two angles can be had where both
  are driven by laws; a `<screw>` ties an angle to a displacement.
- **Cables that go slack**: a `<spring>` with `force="x > 0 ? k*x : 0"`; a `<distance>` holds in pressure as well.
- **Plates, shells, solids, temperature, wake and airfoil aerodynamics**: not there. Drag in
  a stream (`<drag>`), added mass, and loads that are expressions of time and place are.

```xml
<mbd name="door">
  <!-- A door with friction in its hinge, closed by a spring with a target, and an end stop at 0.1 rad. -->
  <body name="leaf" at="0 0 0" mass="20" center="0.45 0 0" inertia="0.1 1.4 1.4" angular_velocity="0 0 3"/>
  <revolute name="hinge" between="ground leaf" axis="0 0 1"/>
  <joint_spring name="friction" joint="hinge" damping_moment="0.8*tanh(v/0.02)"/>
  <joint_spring name="closer" joint="hinge" angular_stiffness="12" angular_damping="4" rest_angle="-1"/>
  <joint_spring name="end_stop" joint="hinge" moment="x > 0.1 ? 2e4*(x - 0.1) : 0"/>
  <transient duration="2" method="radau" tolerance="1e-5" output="0.02"/>
  <record name="hinge" joint="hinge" quantities="angle"/>
  <expect quantity="hinge.angle" of="maximum" value="0.1" tolerance="0.05" source="what gives is less than 3 sqrt(J/k)"/>
</mbd>
```
)md"},
};

// ---- groups of elements -----------------------------------------------------------------------

constexpr Group all_groups[] = {
    {"The model", "mbd include parameter defaults repeat", R"md(Elements may stand in any order.
)md",
     R"xml(<mbd name="balls" version="1">
  <parameter name="n" value="3"/>
  <parameter name="height" value="1.25"/>
  <defaults>
    <body mass="2" inertia="1 1 1"/>
    <record quantities="position"/>
  </defaults>
  <repeat count="n">
    <body name="ball{i+1}" at="i*0.5 0 height"/>
    <record name="ball{i+1}" at="ball{i+1}"/>
  </repeat>
  <gravity acceleration="0 0 -10"/>
  <transient duration="0.5" step="5e-3"/>
  <expect quantity="ball3.position.3" at="0.5" value="0" tolerance="1e-9" source="h - g t^2/2"/>
</mbd>
)xml"},
    {"Sections", "section station stiffness mass damping",
     R"md(A section is constant along the beam, or a table of stations. Models without `<transient>` and
`<gravity>` need no `<mass>`.

Of a homogeneous section of area A, second moments I2 (about b2) and I3 (about b3), torsion constant
It and shear coefficients k2, k3: `EA` = E A, `GA2` = k2 G A, `GA3` = k3 G A, `GJ` = G It, `EI2` =
E I2, `EI3` = E I3; `per_length` = rho A, `inertia` = rho (I2 + I3), rho I2, rho I3. An I-beam along
i1 with its web along `normal` = i3 bends about b2 under vertical loads: EI2 is the strong one.

Elements have the integrals of the table for their mass and stiffness, so that a beam weighs what its table
says on any mesh. Where a linear table has kinks inside elements, convergence is slow; `mesh="stations"`
of the beam ends elements there.

**Infinite stiffnesses.** `EA="inf"`, `GA2="inf"` and so on say that a beam does not stretch, shear, twist or bend that way at
all: the strain is zero at the Gauss points of each element, by multipliers that are the sectional forces recorded there. Not of
all six, without couplings, of the same entries at all stations; of beams with the kinematics, form and rule that are preset,
outside of a `<reduction>`. A straight beam that cannot stretch between two supports that do not give way cannot bend either:
`mbd check` names it. (Equilibria and paths have such multipliers as well where a uniform beam that is preset so stretches or
shears a hundred thousand times less than its elements bend, with the stiffness as it is stated: then no step is set by it, and forces
have no round-off of places; `mbd check` counts them.) It is a statement about the beam and seldom saves time: it has unknowns of its own, equilibria take no more iterations at large stiffness, and
adaptive steps become fewer only where stretching and shearing are left out together.

Resultants N1 Q2 Q3 M1 M2 M3 are what the part behind the section (towards the end) exerts on the
part before it, in section axes: a beam along i1 with `normal` i3 that sags has a negative M2.

Without `<damping>` a beam is elastic, and only the integrator takes energy out. `stiffness_proportional`
= beta [s] adds viscous forces C = beta D times the rates of strain (Kelvin-Voigt: damping ratio beta
omega/2 of a mode of omega, more of the higher ones; none in rigid motion), and the entries by name
add to C. `mass_proportional` = alpha [1/s] takes alpha times the momentum from all masses of the beam,
as a medium at rest would (damping ratio alpha/(2 omega); it slows rigid motion down too, and does not
act on bodies and point masses). Recorded forces and moments hold the viscous part; `work_of_damping`
is what both took out. Beams of `kinematics="classical"` can have `mass_proportional` only. In
equilibria damping does nothing.
)md",
     R"xml(<mbd name="mast">
  <!-- A mast that tapers, under its weight and a push at its top. -->
  <section name="tapered" interpolation="smooth">
    <station at="0">
      <stiffness EA="8e6" GA2="3e6" GA3="3e6" GJ="6e3" EI2="8e3" EI3="8e3"/>
      <mass per_length="4" inertia="4e-3 2e-3 2e-3"/>
    </station>
    <station at="0.5">
      <stiffness EA="6e6" GA2="2e6" GA3="2e6" GJ="3e3" EI2="4e3" EI3="4e3"/>
      <mass per_length="3" inertia="2e-3 1e-3 1e-3"/>
    </station>
    <station at="1">
      <stiffness EA="4e6" GA2="1e6" GA3="1e6" GJ="1e3" EI2="1e3" EI3="1e3"/>
      <mass per_length="2" inertia="1e-3 5e-4 5e-4"/>
    </station>
  </section>
  <beam name="mast" section="tapered" from="0 0 0" to="0 0 5" normal="1 0 0" elements="4"/>
  <fixed name="foot" between="ground mast.start"/>
  <load at="mast.end" force="20 0 0"/>
  <gravity acceleration="0 0 -9.81"/>
  <static/>
  <record name="top" at="mast.end" quantities="displacement"/>
</mbd>
)xml"},
    {"Sections from material",
     "material layup ply tube bar rectangle box I C mesh region airfoil points sector web",
     R"md(In place of `<stiffness>` and `<mass>` a section, or each of its stations, may have a shape. D and M
are then computed when the model is read, by finite elements over the section with three displacements
of warping a node; the mesh is refined until every entry ij of D changes by less than `tolerance`
sqrt(Dii Djj), and beams use the result as if its numbers stood there. `mbd section MODEL` prints D, M,
centres, principal axes and the estimated error of every entry. A `<mass>` beside the shape takes the
place of the computed one.

A wall consists of plies, or of one `material` and its thickness. With the outward normal n of the wall
and the angle theta of a ply, its fibres lie along L = cos(theta) b1 + sin(theta) (n x b1): theta is
positive when L turns from b1 right-handed about n. `listed` says whether the first ply of a layup is the
innermost or the outermost one; angles mean the same in both cases. The normal of a rectangle is b3, of
flanges it points away from the middle, of the web of an I it is b2, of the web of a C -b2.

D and M are about the reference line, x2 = x3 = 0; `x2`, `x3` and `turn` place the shape in the section.
`curvature` is that of the stress-free beam along b1 b2 b3: a straight beam has none, an arc of radius R
whose centre lies on the side of b2 has k3 = 1/R. A beam does not hand its own to its section.

A `<mesh>` is read from a file of Gmsh, each of whose physical surfaces is a `<region>` of a material; triangles have
3 or 6 nodes, quadrilaterals 4, 8 or 9. Its elements stay, and their order is raised from 1 to 8 until D changes less than
`tolerance`; where stresses are singular, make the mesh finer there. Overlapping or inverted elements, parts that
are not joined along sides, and seams with two sets of nodes are refused.

An `<airfoil>` has walls along a closed curve: `<points>` of its outer surface, listed all round from any of them and
either way. Where the line from point to point turns by more than `corner_angle` there are corners, as at a sharp or blunt trailing
edge; between them it is a cubic spline (60 deg: with 30 points or more a side the nose of an aerofoil is no corner). With
`corner_angle="0"` it is a polygon. Fractions are those of the length of this curve from the first point on, in the order
of the points. `<sector>`s cover it; where one is `bare="on"` the section is open. Interfaces of plies lie at constant distances
inside the curve, so walls must be thinner than its radius. At corners plies turn on a line (mitred) or, `corners="butt"`, walls
of the sector that is listed first go through. `<web>`s are straight and stand on the inner surfaces; elements of walls and
webs meet by nodes. Refused, by name and place: contours that cross themselves, sectors that overlap or leave a hole, plies that
do not fit, webs that end where there is no wall or on a corner, that cross, or that meet a wall at less than 15 degrees, walls that run
into each other, pieces that are joined to nothing. A mesh gets finer at corners, feet of webs and borders of sectors;
`tolerance` is 1e-4 there, as aerofoils with many plies are dear: `mbd section MODEL --accuracy` says what each tolerance costs.

Stresses and strains in plies: `<record at="arm@0.1" section_point="0 49.5 mm" quantities="ply_stress tsai_wu"/>` at a
point x2 x3 of the section, from the resultants there; `mbd section MODEL --stress "N Q2 Q3 M1 M2 M3"`, or `--run DIR
--record NAME`, over all of a section. They are along the axes L T N of the ply. Where plies meet, stresses jump, so a point
must lie in one of them. They leave out what dies out near ends of a beam and near loads. A section that varies
is known at its stations only.

Failure indices max_stress, tsai_hill, tsai_wu and hashin need the strengths of a material. An index of 1 is failure, and all are in
proportion to the load: at an index of 0.5 twice the load is borne. (The sum that books call Tsai-Hill is the
square of the index.) Isotropic materials have a `yield` stress and the yield_index.

Materials are linear and elastic. A material is refused where its constants are not those of a positive
definite one: -1 < nu < 0.5, |nuLT| < sqrt(EL/ET). Units are those of all attributes: `E="210 GPa"`,
`rho="1.6 g/cm3"`.

`block.msh`:

```text
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
2 1 "core"
$EndPhysicalNames
$Nodes
6
1 -10 -5 0
2 0 -5 0
3 10 -5 0
4 -10 5 0
5 0 5 0
6 10 5 0
$EndNodes
$Elements
3
1 3 2 1 1 1 2 5 4
2 2 2 1 1 2 3 6
3 2 2 1 1 2 6 5
$EndElements
```

)md",
     R"xml(<mbd name="composite_tube">
  <!-- A cantilever that twists when it is bent, as its plies wind round it one way. -->
  <material name="graphite_epoxy" EL="181 GPa" ET="10.3 GPa" GLT="7.17 GPa" nuLT="0.28" nuTN="0.33" rho="1600"
            Xt="1500 MPa" Xc="1500 MPa" Yt="40 MPa" Yc="246 MPa" SLT="68 MPa" STN="60 MPa"/>
  <layup name="wall" listed="inside">
    <ply material="graphite_epoxy" thickness="1 mm"/>
    <ply material="graphite_epoxy" thickness="1 mm" angle="30 deg"/>
  </layup>
  <section name="tube"> <tube radius="50 mm" layup="wall"/> </section>
  <!-- Others, of one material. -->
  <material name="steel" E="210 GPa" nu="0.3" rho="7850"/>
  <defaults>
    <I material="steel" tolerance="1e-3"/> <C material="steel" tolerance="1e-3"/> <box material="steel" tolerance="1e-3"/>
  </defaults>
  <section name="rod"> <bar radius="10 mm" material="steel"/> </section>
  <section name="strip"> <rectangle width="40 mm" height="5 mm" material="steel"/> </section>
  <section name="block"> <mesh file="block.msh" unit="1 mm"> <region name="core" material="steel"/> </mesh> </section>
  <section name="hollow"> <box width="60 mm" height="40 mm" thickness="4 mm"/> </section>
  <section name="girder"> <I width="80 mm" height="160 mm" flange_thickness="8 mm" web_thickness="6 mm"/> </section>
  <section name="rail"> <C width="40 mm" height="80 mm" flange_thickness="6 mm" web_thickness="5 mm"/> </section>
  <section name="spar"> <!-- a nose with a web, open behind it -->
    <airfoil unit="1 mm" tolerance="1e-2">
      <points> 200 0  80 25  40 24  15 16  3 6  0 0  3 -6  15 -16  40 -24  80 -25 </points>
      <sector from_point="3" to_point="9" layup="wall"/>
      <sector from_point="9" to_point="3" bare="on"/>
      <web from_point="3" to_point="9" material="steel" thickness="2 mm"/>
    </airfoil>
  </section>
  <beam name="arm" section="tube" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
  <fixed name="wall" between="ground arm.start"/>
  <load at="arm.end" force="0 0 -100"/>
  <static/>
  <record name="tip" at="arm.end" quantities="displacement rotation"/>
  <record name="root" at="arm@0.1" section_point="0 49.5 mm" quantities="ply_stress ply_shear_stress tsai_wu"/>
</mbd>
)xml"},
    {"Beams", "beam arc curve point",
     R"md(A beam has `elements` spectral elements of `order` N. Its ends are free until a joint holds them.
)md",
     R"xml(<mbd name="hook">
  <section name="bar">
    <stiffness EA="2e7" GA2="7e6" GA3="7e6" GJ="1.3e3" EI2="1.7e3" EI3="1.7e3"/>
  </section>
  <beam name="leg" section="bar" from="0 0 0" to="0 0 2" normal="0 1 0" elements="2"/>
  <arc name="bow" section="bar" from="0 0 2" center="0.5 0 2" axis="0 1 0" angle="pi" normal="0 1 0"
       elements="2" order="5"/>
  <curve name="tail" section="bar" normal="0 1 0" elements="2">
    <point at="1 0 2"/>
    <point at="1.02 0 1.8"/>
    <point at="1.1 0 1.6" twist="10*deg"/>
  </curve>
  <fixed name="foot" between="ground leg.start"/>
  <fixed name="A" between="leg.end bow.start"/>
  <fixed name="B" between="bow.end tail.start"/>
  <load at="tail.end" force="0 0 -50"/>
  <static/>
  <record name="end" at="tail.end" quantities="displacement rotation"/>
  <record name="leg" at="leg@0.5" quantities="force moment"/>
  <expect quantity="leg.force.1" value="-50" tolerance="0.1"
          source="equilibrium: the leg is pressed"/>
</mbd>
)xml"},
    {"Bodies", "body shape point_mass rigid reduction",
     R"md(A free body has a frame of its own. One that is `attached_to` a place adds its mass there.

`<rigid>` makes one body of beams and free bodies: one node in the frame of the first of them, with the mass of them all.
Places of its beams stay places, for joints, loads, masses and records; sectional forces are not determined in it. Which
beams may be rigid without changing a result: `mbd effects`. `<reduction>` makes one element of component modes of them:
for parts that are bent and loaded little, far from buckling.

What a body looks like is said by `<shape>`s inside it: boxes, cylinders, spheres, and meshes that other programs wrote (STL, OBJ,
glTF). They cost a run nothing. One with a `density` is solid and adds its mass, so that a body need not state any; a mesh must then
be closed: each part of it is a solid, or hollow where it lies in another and is turned the other way; what two parts share counts twice.
Without shapes a body is drawn as the solid that has its mass and inertia. A body `attached_to="ground"` with shapes is
scenery. Beams are drawn with the outline of their section where that is stated by its shape (of stations, where those have one
shape and differ in its sides, and little else), with what a `<shape>` inside them says, or with the radii of gyration that their
stiffness has.
)md",
     R"xml(<mbd name="top_and_rotor">
  <!-- A disk on the end of a shaft, and a body that tumbles in space. -->
  <section name="shaft">
    <stiffness EA="2e7" GA2="7e6" GA3="7e6" GJ="1.3e3" EI2="1.7e3" EI3="1.7e3"/>
    <mass per_length="0.8" inertia="1e-4 5e-5 5e-5"/>
  </section>
  <beam name="shaft" section="shaft" from="0 0 0" to="1 0 0" normal="0 0 1"/>
  <fixed name="wall" between="ground shaft.start"/>
  <body name="disk" attached_to="shaft.end" mass="5" inertia="0.1 0.05 0.05"/>
  <point_mass name="unbalance" at="disk" mass="0.1" offset="0 0.05 0"/>
  <reduction name="rotor" of="shaft disk" modes="4"/>
  <beam name="arm" section="shaft" from="0 3 0" to="0.5 3 0" normal="0 0 1"/>
  <body name="fist" at="0.5 3 0" mass="2" inertia="0.01 0.01 0.01" velocity="0 0 0.1"/>
  <rigid name="boom" of="arm fist"/>
  <body name="rock" at="0 2 0" orientation="0 0 45*deg" mass="1" inertia="1 2 2.5"
        velocity="0.1 0 0" angular_velocity="0 1 0.01"/>
  <!-- A hammer of two solids, on a floor that is only seen. -->
  <body name="hammer" at="0 4 0" angular_velocity="0 0 1">
    <shape box="0.03 0.1 0.03" density="7800" colour="gray"/>
    <shape cylinder="0.03 0.3" at="0.15 0 0" orientation="0 pi/2 0" density="700" colour="maroon"/>
  </body>
  <body name="floor" attached_to="ground"><shape box="3 8 0.1" at="0 2 -1" colour="silver"/></body>
  <transient duration="0.1" step="1e-3"/>
  <record name="rock" at="rock" quantities="position angular_velocity"/>
  <record name="disk" at="disk" quantities="displacement"/>
  <expect quantity="rock.position.1" at="0.1" value="0.01" tolerance="1e-6"
          source="no force acts"/>
</mbd>
)xml"},
    {"Joints", "",
     R"md(A joint joins the places a and b of `between`, in that order: its angle turns b relative to a,
right-handed about its axis, and its displacement moves b along it. Both are 0 at the start.

A joint has axes e1 e2 e3, in which reactions are recorded. At the start e3 is along `axis`; e1 is
along `second_axis` or, without one, along i_k x e3, i_k being the inertial axis with the least
component along e3 (the first of equals); e2 = e3 x e1. Joints without an axis have the inertial
ones. They move with b. Reactions are what the joint exerts on b: with the places exchanged, they
change their sign. For an axis along i2, e1 = i1 x i2 = i3 and e2 = i1.

What `<fixed>` joins is one node where that changes nothing but the cost: no multipliers, and elements, masses, loads and
records that sit in it as the geometry says (`mbd check` counts them as fused, `mbd explain` names them). A fixed joint keeps
its six multipliers where one of its places is the ground, where a record reads it (its reactions are these multipliers),
where the things it joins are held together twice or have another joint, spring or bushing between them, where their initial
velocities differ, and with `inertia="no_gyroscopic"`. Large frames are cheap, then, when few of their joints are recorded:
forces and moments at the ends of beams need no multipliers.

Usual supports of a beam `b`: clamped, `<fixed between="ground b.start" …/>`; a hinge about i2,
`<revolute between="ground b.start" axis="0 1 0" …/>`; a roller along i1, `<point_on_line
between="b.end ground" axis="1 0 0" …/>` (a point of the beam on a line of the ground), which leaves all rotations free.

A drive or motion that starts at a rate needs bodies that move with it: give them `velocity` and
`angular_velocity`, or let the drive start from rest (`rate="1 > t ? 6*t : 6"`); beams start at rest.
)md",
     R"xml(<mbd name="swing">
  <!-- A rod falls from the horizontal about a hinge; a bob hangs on its end by a ball joint. -->
  <body name="rod" at="0 0 0" center="0.5 0 0" mass="2" inertia="0.01 1/6 1/6"/>
  <revolute name="hinge" between="ground rod" axis="0 1 0"/>
  <body name="bob" at="1 0 -0.3" mass="1" inertia="0.01 0.01 0.01"/>
  <spherical name="ball" between="rod bob" at="1 0 0"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="0.5" step="1e-3"/>
  <record name="hinge" joint="hinge" quantities="angle rate reaction_force"/>
  <record name="all" quantities="total_energy"/>
  <expect quantity="all.total_energy" of="maximum" value="-0.3*9.81" tolerance="1e-3"
          source="energy"/>
</mbd>
)xml"},
    {"Drives and motions", "drive motion",
     R"md(A drive needs a joint that leaves its coordinate free. Force and work of what is prescribed can be
recorded.
)md",
     R"xml(<mbd name="wiper">
  <!-- A carriage on a prescribed path; on it, an arm that a motor brings to 60 rpm. -->
  <parameter name="speed" value="2*pi"/>
  <body name="carriage" mass="10" inertia="1 1 1"/>
  <motion name="path" of="carriage" displacement="0.2*(1-cos(pi*t)) 0 0" rotation="0 0 0"/>
  <body name="arm" at="0 0 0" center="0 0 0.25" mass="1" inertia="0.02 0.02 0.001"/>
  <revolute name="shaft" between="carriage arm" axis="0 1 0"/>
  <drive joint="shaft" rate="0.5 > t ? speed*sin(pi*t)^2 : speed"/>
  <transient duration="1" step="2e-3"/>
  <record name="shaft" joint="shaft" quantities="angle rate reaction_moment"/>
  <record name="path" joint="path" quantities="reaction_force"/>
  <expect quantity="shaft.angle" at="1" value="1.5*pi" tolerance="1e-9"
          source="integral of the rate"/>
</mbd>
)xml"},
    {"Inputs from a program", "input",
     R"md(An input is a number that a program sets between steps: a controller, an aeroelastic code, a simulator that has libmbd
as a part. The laws of loads, distributed loads, joint torques, drags and drives use it by its name, beside t, parameters and
functions; it stands before them in the file. An input with a `unit` is set in that unit.

A value may be held, or go on in a straight line or a parabola, over a step; where a load jumps by that the step begins with
the accelerations that the new load gives. Conditions, `min`, `max` and `abs` of an input are not taken: the times at which
they switch are not known, and the program can do it. What a `<drive>` or `<motion>` prescribes may depend on an input by its
`angle` or `displacement`, and must not jump. Before a run laws are looked through for short pulses: those with inputs, or with sensors, at three sets of values that
these are held at (0, about 1 and about -0.6 in SI units), so that a pulse in time is seen; what inputs and sensors do is followed by errors of steps only. `mbd run` and all studies keep inputs at their `value`; `mbd linearize` gives the
matrices from inputs to what is recorded. `mbd check` counts inputs.
)md",
     R"xml(<mbd name="servo_arm">
  <!-- A horizontal arm held by a motor whose torque a program sets; here it keeps its first value, the arm's weight. -->
  <input name="torque" unit="N.mm" value="-4905"/>
  <body name="arm" at="0 0 0" center="0.5 0 0" mass="1" inertia="0.001 0.08 0.08"/>
  <revolute name="shoulder" between="ground arm" axis="0 1 0"/>
  <joint_torque joint="shoulder" moment="torque"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="0.5" step="1 ms"/>
  <record name="shoulder" joint="shoulder" quantities="angle rate"/>
  <expect quantity="shoulder.angle" at="0.5" value="0" tolerance="1e-9" source="equilibrium"/>
</mbd>
)xml"},
    {"Control", "function controller state output pid state_space",
     R"md(A function of time is called by the laws of loads, drives and controllers after it, at t or at an argument a*t + b: `ref(t)`,
`ref(t-0.2)`. A table of it is linear beyond its ends.

**Sensors.** The laws of loads, distributed loads and joint torques, and controllers, know the motion by names: what has it and
what it is, as `<record>` names it, with the number of the component behind a vector. `elbow.angle` and `elbow.rate` of a joint,
`rail.displacement` and `rail.speed`, `hub.velocity.2` of a body, `arm.end.displacement.3` or `arm@0.5.position.1` of a beam, in SI
units and rad. A name with a `-` in it cannot be used.

**At once.** `moment="-k*(elbow.angle-ref(t))-c*elbow.rate"` acts inside the iterations of each step with its exact tangent, as a
spring does, however stiff it is; in equilibria rates are 0, and in linear analyses it is part of the matrices. Such a law has a
derivative: it knows joint angles, displacements and their rates, and of places with a node position, displacement, velocity and
angular velocity (the last two also `_local`), and neither compares sensors nor takes their `abs`, `min`, `max` (write `a*tanh(u/a)`).

**Sampled.** A controller looks at the motion at the instants t = 0, `period`, 2 `period`, …, where steps of all methods end. At each,
what it consists of is evaluated in its order: expressions know t, sensors (all that can be recorded without a section_point), inputs, outputs before
them and those of controllers before it, and the states as they were; after that the states take their next values. What comes out
acts from that instant on, without delay, until the next; accelerations jump there, and are made consistent. A sensor of an
acceleration or a reaction tells what it was just before, and the inputs of a program are those of the step that ends there: what
it sets then is seen at the next instant. Conditions and kinks may be of anything. Before t = 0, and in a `<static>`, an
output is its `start`; linear analyses hold outputs.

A `pid` with error e, period T and filter time F has the output P + I + D, limited, with
P = kp e, D(k) = (F D(k-1) + kd (e(k) - e(k-1))) / (F + T), D(0) = 0, and I(k+1) = I(k) + ki T e(k), but where the output is at
a limit and this would drive it further. The matrices of a `state_space` are of discrete time.
)md",
     R"xml(<mbd name="two_carts">
  <!-- A controller brings a cart to its target in two periods; a second cart follows it by a law of sensors. -->
  <parameter name="m" value="2 kg"/>
  <parameter name="T" value="0.1"/>
  <function name="target" unit="mm">0 300  5 300</function>
  <controller name="servo" period="T">
    <output name="push" value="m*((target(t)-cart.position.1)/T^2-1.5*cart.velocity.1/T)"/>
  </controller>
  <controller name="trim" period="2*T">
    <state name="count" next="count+1"/>
    <output name="fade" value="count &lt; 3 ? 1 : max(0, 1-(count-3)/5)"/>
    <pid name="brake" error="-track.speed" proportional="2" integral="1" limits="-5 5"/>
    <state_space inputs="track.speed" outputs="smooth" A="0.8" B="0.2" C="1"/>
  </controller>
  <body name="cart" mass="m" inertia="1 1 1"/>
  <body name="wagon" at="-0.5 0 0" mass="1" inertia="1 1 1"/>
  <prismatic name="rail" between="ground cart" axis="1 0 0"/>
  <prismatic name="track" between="ground wagon" axis="1 0 0"/>
  <load at="cart" force="push 0 0"/>
  <load at="wagon" force="400*(rail.displacement-track.displacement)+40*(rail.speed-track.speed)+fade*brake-0.1*smooth 0 0"/>
  <transient duration="0.5" step="0.01"/>
  <record name="cart" joint="rail" quantities="displacement speed"/>
  <record name="wagon" joint="track" quantities="displacement speed"/>
  <expect quantity="cart.displacement" at="0.2" value="0.3" tolerance="1e-9" source="x(k+2) = target"/>
  <expect quantity="cart.speed" at="0.2" value="0" tolerance="1e-8" source="the same"/>
</mbd>
)xml"},
    {"Loads", "load distributed gravity",
     R"md(Dead loads keep their inertial direction; follower loads turn with the section or body.

A distributed load is sampled at the nodes of the elements: it should be smooth within each. Where
it begins and ends, say so by `from` and `to`, which make ends of elements; a condition on `s`
inside an element costs accuracy. A load that moves along a beam is best a smooth bump several nodes
wide (`exp(-((s-v*t)/w)^2)`), with the beam divided finely enough.
)md",
     R"xml(<mbd name="beam_in_wind">
  <section name="tube">
    <stiffness EA="4e7" GA2="1e7" GA3="1e7" GJ="5e4" EI2="6e4" EI3="6e4"/>
    <mass per_length="5" inertia="2e-2 1e-2 1e-2"/>
  </section>
  <beam name="boom" section="tube" from="0 0 0" to="3 0 0" normal="0 0 1" elements="2" order="4"/>
  <fixed name="wall" between="ground boom.start"/>
  <gravity acceleration="0 0 -9.81"/>
  <distributed name="wind" beam="boom" follower_force="0 80*s*(1-cos(20*t)) 0"/>
  <load name="rope" at="boom.end" force="0 0 min(2000*t,100)"
          follower_moment="5 0 0" offset="0 0.1 0"/>
  <static/>
  <transient duration="0.2" step="1e-3"/>
  <record name="tip" at="boom.end" quantities="displacement rotation"/>
  <record name="root" joint="wall" quantities="reaction_force reaction_moment"/>
</mbd>
)xml"},
    {"Fluid and base", "drag added_mass base_motion",
     R"md(Along a beam, flow across and along it act apart (the independence principle): per length
-1/2 rho d C_n |u_n| u_n across and -1/2 rho pi d C_t |u_t| u_t along, u being the velocity against
the fluid. At a place the drag is -1/2 rho A C |u| u. Coefficients are constants. Drag is sampled at the
nodes of elements, as distributed loads are. In statics there is drag of a `flow` only, multiplied by
the load factor. The power of drag, of a flow too, is booked as work of damping.

Added mass is that of a fluid at rest which a body sets in motion: along a beam rho C pi d^2/4 per
length, across it only; at a place a matrix of its velocities there, which need not be that of a rigid
body (Kirchhoff's equations). It adds to inertia, momentum and kinetic energy, not to weight. Buoyancy
and the forces of a fluid that is accelerated itself are not in it: state buoyancy as a load, or by a
reduced gravity.

`<base_motion>` accelerates the ground, without turning it. Everything - places, velocities, records,
`flow` - is relative to the ground then, and each mass m feels -m times its acceleration; the fluid of
an added mass moves with the base. Its work is one of loads. A static equilibrium is that of the
acceleration at t = 0, multiplied by the load factor.
)md",
     R"xml(<mbd name="pier">
  <!-- A pier in a current, shaken by an earthquake. -->
  <section name="tube">
    <stiffness EA="6e9" GA2="2e9" GA3="2e9" GJ="1e9" EI2="1.3e9" EI3="1.3e9"/>
    <mass per_length="900" inertia="400 200 200"/>
  </section>
  <beam name="pier" section="tube" from="0 0 0" to="0 0 30" normal="1 0 0" elements="3" order="4"/>
  <fixed name="bed" between="ground pier.start"/>
  <body name="deck" attached_to="pier.end" mass="2e4" inertia="2e5 2e5 2e5"/>
  <drag beam="pier" to="2/3" density="1025" diameter="1.2" normal_coefficient="1"
        tangential_coefficient="0.01" flow="0 1.5 0"/>
  <added_mass beam="pier" to="2/3" density="1025" diameter="1.2" coefficient="1"/>
  <drag at="deck" density="1.2" area="40" coefficient="1.3" flow="0 25 0"/>
  <base_motion acceleration="2*sin(12*t)*exp(-t) 0 0"/>
  <static/>
  <transient duration="1" step="5e-3" rho_infinity="0.8"/>
  <record name="deck" at="deck" quantities="displacement"/>
  <record name="bed" joint="bed" quantities="reaction_force"/>
  <expect quantity="bed.reaction_force.2" at="0"
          value="-0.5*1025*1.2*1.5^2*20-0.5*1.2*1.3*40*25^2" tolerance="50"
          source="equilibrium of a pier that stands upright"/>
</mbd>
)xml"},
    {"Springs and dampers", "spring bushing joint_spring joint_torque table law matrix",
     R"md(A `<spring>` acts along the line between two points, a `<bushing>` in all six directions between two
frames, a `<joint_spring>` on the free coordinate of a joint; each may damp as well, and what is
stated adds up. A `<joint_torque>` is a motor that does not prescribe how fast.

Besides constant coefficients there are laws: expressions of the displacement `x` or of its rate `v`
(`force="1e4*x + 1e7*x^3"`, `damping_force="50*v*abs(v)"`), or tables, linear between their points or
smooth, and linear beyond the first and the last. A law is continuous; its conditions and kinks
compare terms `a*x + b`, as those of time do. Adaptive steps of radau and generalized_alpha end where x passes a kink and turns
back (a stop that is just touched), and before a peak of a law that they would go over, in x, in v or in a sensor of a load; fixed
steps, and ida, count what they passed over, and the certificate warns. Of a law with several sensors each is looked at with the
others as they are at the start. Peaks may be missed that move with other sensors, that are narrower than some 1e-4 of the range of
their argument, and, in v and with generalized_alpha above all, those beyond which a whole step has a solution too: `max_step` bounds
steps there.

The motion of a bushing is six numbers: for small motions the displacement and the rotation of b from
a along and about its axes; for large ones those of the screw motion that takes a to b, so that
neither side is preferred. It reaches to 0.9 of half a turn; what turns further has a joint.
)md",
     R"xml(<mbd name="gate">
  <body name="leaf" at="0 0 0" mass="20" center="0.6 0 0" inertia="0.1 2.5 2.5"/>
  <bushing name="mount" between="ground leaf" damping="2e3 2e3 2e3"
           angular_damping="40 40 0">
    <matrix of="stiffness">
      2e6 0 0 0 0 0  0 2e6 0 0 0 0  0 0 2e6 0 0 0
      0 0 0 4e4 0 0  0 0 0 0 4e4 0  0 0 0 0 0 0
    </matrix>
    <law component="6" moment="50*x^3"/>
  </bushing>
  <spring name="closer" between="ground leaf" at_a="0.3 0.5 0" at_b="0.8 0.05 0"
          stiffness="300" length="0.4" damping="60" damping_force="200*v*abs(v)"/>
  <body name="latch" at="1.2 0 0" mass="0.3" inertia="1e-3 1e-3 1e-3"/>
  <revolute name="hinge" between="leaf latch" axis="0 0 1"/>
  <joint_spring name="return" joint="hinge" angular_stiffness="2" angular_damping="0.05"
                rest_angle="10 deg">
    <table of="moment" interpolation="smooth">-1 -3  0 0  0.5 0.2  1 3</table>
  </joint_spring>
  <joint_torque name="motor" joint="hinge" moment="t > 0.1 ? 0.5*(1 - exp(-(t-0.1)/0.02)) : 0"/>
  <transient duration="0.2" step="2e-3"/>
  <record name="closer" spring="closer" quantities="tension length length_rate"/>
  <record name="mount" spring="mount" quantities="force moment"/>
  <record name="return" spring="return" quantities="joint_moment"/>
</mbd>
)xml"},
    {"Analyses", "static transient",
     R"md(`<static>` alone is the equilibrium under the loads of t = 0; `<transient>` alone starts from the
reference configuration with the velocities given; both, from the equilibrium. A transient needs
mass in every beam.

A `<transient>` goes in fixed steps (`step`), of which the duration must be a whole number, or in
steps that follow an estimated error (`tolerance`). The methods:

- `generalized_alpha`, the default, is of order 2, with numerical damping by choice
  (`rho_infinity`). A step costs least. For a few digits, for very many unknowns, for fixed steps.
- `radau`, Radau IIA, damps what its steps do not resolve. A step costs several times as much, and
  takes the place of the more steps of generalized-alpha the more digits are wanted. For accuracy,
  and for fast and slow phases in one run. Steps have three, five or seven stages (`stages`), of
  order 5, 9 and 13: those that follow a tolerance as many as come farthest for their work, which
  they try as they go (`stages="auto"`), fixed ones three unless told otherwise. More than three
  are for many digits of smooth motions, and make slower what passes singular positions at every
  turn (models/windows.xml; `stages="3"` is there for it).
- `ida`, IDA of SUNDIALS, is a multistep method of variable order, 1 to 5, always with a tolerance.
  An independent check of the others; best where motions are smooth for many steps.

`tolerance="1e-6"` asks for errors of a millionth: of positions, relative to the size of the scene; of
rotations, to a radian; of velocities, to what moves fastest at the time. Limits in units
(`position_tolerance="1 um"`, `rotation_tolerance`, `velocity_tolerance`,
`angular_velocity_tolerance`) take its place for one kind (of velocities not with generalized_alpha,
which estimates errors of positions and rotations only). The error of each step is estimated and
held below what makes the error of the whole go with the tolerance; the error at the end is of its
size where the motion does not amplify errors, and larger where it does (a chaotic motion has no
digits to offer after a while, with any method). So compare a run with one of a tolerance ten times
smaller. `report.json` and the summary have the steps accepted and rejected, the shortest and the
longest, and the sum of the estimated errors.

Stiff parts, as bars along their axes, carry waves of small amplitude whose velocities need steps many times
shorter than the positions do. With `errors="motion"` steps of radau are held by the errors of positions and rotations
alone, relative to the largest motion so far, and what such waves do is damped where steps are too long for it; forces,
accelerations and energies of stiff strains are then wrong by what those waves are. It is the default where nothing
is recorded that would see it: positions, rotations, angles and lengths only. `errors="velocities"` holds them as well. What
was left is said at the end of the run.

`inertia="no_gyroscopic"` leaves out the moment w x J w of what moves with a node, J being its inertia
about its mass centre: all else of inertia stays, J dw/dt in body axes among it. Of a sphere's J there
is no such moment; of any other, whirling and precession are those of a sphere with the transverse
inertia, and angular momentum is not kept. It tells what the moment is worth.

Results are rows of `history.csv` at the times of `output`: every so many seconds, interpolated
within steps to the order of the method without disturbing them (positions and velocities; constraint
forces and accelerations to lower order), or `output="steps"`, where each step ends. Without `output`
there is a row at each fixed step, or with a tolerance a thousand rows. There is one at t = 0 and one
at the end always, and after a jump of a load the row has the state after it. An `<expect>` of a
value must be at such a time; with `output="steps"` at any. Extremes are those of the rows.

The command line has the last word: `mbd run MODEL --method radau --tolerance 1e-8` (rows stay where
the model's own steps would give them), `--step "0.5 ms"`, `--output steps`.
)md",
     R"xml(<mbd name="released">
  <!-- A cantilever sags under its weight, then its tip is let go of a rope. -->
  <section name="strip">
    <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="0.5" inertia="2e-4 1e-4 1e-4"/>
  </section>
  <beam name="b" section="strip" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="4"/>
  <fixed name="clamp" between="ground b.start"/>
  <gravity acceleration="0 0 -9.81"/>
  <load name="rope" at="b.end" force="0 0 0.01>t?5:0"/>
  <static steps="2"/>
  <transient duration="0.2" step="1e-3" rho_infinity="0.8"/>
  <record name="tip" at="b.end" quantities="displacement velocity"/>
  <expect quantity="tip.velocity.3" at="0" value="0" tolerance="1e-9"
          source="starts from equilibrium"/>
</mbd>
)xml"},
    {"Paths of equilibria", "path mark stop",
     R"md(`<path>`, in place of `<static>` and `<transient>`, follows the equilibria from the unloaded
reference configuration while one load factor multiplies every load, gravity and prescribed motion:
through limit points, where the load falls again, and past bifurcations, where other equilibria
branch off. Both are located and reported; `branch` follows one of the branches. A run writes
`path.csv` (columns `load_factor`, `arc_length`, `branch`: 0 from the start, -1 backward, 1 from a
bifurcation; `event`: 0 none, 1 limit point, 2 bifurcation, 3 mark or stop;
`negative_eigenvalues`; and the records), `path.svg`, `shapes.svg` (the deformed beams at the events) and
`report.json`.

`negative_eigenvalues` counts the ways in which an equilibrium is unstable: 0 is stable, -1 not known
to round-off. It is there
when all forces have a potential: no dead moments, no follower loads, beams not in the paper's
form. Without it the twelve motions nearest to losing stability are followed from point to point (by their shapes; where they
cannot be told apart steps become shorter), and bifurcations are where one of them does: two at once, as of a round column, are
said to be two. A flutter is no bifurcation: `mbd modes` finds it.

A path goes on until a `<stop>`, its `length` or its `points`. Where a law has a kink (a stop, a rope) it has a corner, which is
passed and noted.
)md",
     R"xml(<mbd name="snap_through">
  <!-- A flat arch is pressed at its crown, gives way and hangs through. -->
  <section name="strip">
    <stiffness EA="1e8" GA2="1e8" GA3="1e8" GJ="1e8" EI2="1e8" EI3="1e8"/>
  </section>
  <arc name="arch" section="strip" from="-100*sin(15*deg) 100*cos(15*deg) 0" center="0 0 0"
       axis="0 0 -1" angle="30*deg" normal="0 0 1" elements="4" order="4"/>
  <revolute name="left" between="ground arch.start" axis="0 0 1"/>
  <revolute name="right" between="ground arch.end" axis="0 0 1"/>
  <load at="arch@0.5" force="0 -2e5 0"/>
  <path step="0.1">
    <mark quantity="crown.displacement.2" value="-3"/>
    <stop quantity="crown.displacement.2" value="-7"/>
  </path>
  <record name="crown" at="arch@0.5" quantities="displacement"/>
  <plot x="crown.displacement.2" x_scale="-1" y="load_factor"/>
  <expect quantity="load_factor" of="limit" number="1" value="0.969750962" tolerance="1e-6"
          source="shooting of the rod equations"/>
</mbd>
)xml"},
    {"Modes", "modes",
     R"md(`<modes/>` asks for modes of small motions: what `mbd modes` finds, whose options have the names of these
attributes and hold before them. It changes nothing in a run. `mbd run` writes `modes.csv` (a row a mode) and
`modes.json` (with shapes) beside the results of a run that came to its end, and prints what `mbd modes` would;
sweeps and studies, which run a model many times, do not. Without `rate` and `at` modes are those about the
static equilibrium at t = 0, as `<static>` finds it.

With `mac="on"` there are `mac.csv` (a row a mode and another) and `mac.json`, which say how alike shapes a, b are:
|a^H M b|^2/((a^H M a)(b^H M b)), the modal assurance criterion weighted by mass M, 1 of the same shape, 0 with
nothing in common. M makes one sum of displacements and rotations, and of nodes that stand closely here and widely there. Modes of what
neither damps nor turns are orthogonal in it; others need not be. Of an eigenvalue that is there
several times, as bending of a round shaft, any mixture of its shapes is one too: such modes are a group, compared as a whole
(`mac_of_groups`: the squares of the cosines of the principal angles between two spans, their mean over the smaller
dimension; of single modes the criterion itself). `mbd modes MODEL --compare OTHER` compares them with modes of another
model or of a `modes.json`, at nodes of the same names, and says which is which.
)md",
     R"xml(<mbd name="fork">
  <!-- A strip bent by a small force, and its frequencies then. -->
  <material name="steel" E="200 GPa" nu="0.3" rho="7800 kg/m3"/>
  <section name="strip"> <rectangle width="10 mm" height="2 mm" material="steel"/> </section>
  <beam name="prong" section="strip" from="0 0 0" to="0.2 0 0" normal="0 0 1" elements="2" order="5"/>
  <fixed name="root" between="ground prong.start"/>
  <load at="prong.end" force="0 0 -0.1"/>
  <static/>
  <modes count="4" mac="on"/>
  <record name="tip" at="prong.end" quantities="displacement"/>
</mbd>
)xml"},
    {"Results", "record motion_output plot expect",
     R"md(A run writes `history.csv` (the records, a row per time step), `history.svg` (the plots) and
`report.json`. A column is called by its record, its quantity and, if that has three components,
their number: `tip.displacement.3`. `mbd run` ends with exit status 2 when a number is not as
expected.

What acts at a place of a beam, or joins or holds it, has a node there, where elements end. A record
has none and changes nothing else: within an element it reads the motion that the element interpolates
between its nodes, of order N + 1 in the length of elements (at their ends 2N), with the velocity and
acceleration that belong to it, and the resultants of that element.

Every file of a run bears its id, 16 digits that no other run has. `mbd compare`, `plot`, `view` and `export` say when files
beside each other are of different runs, when the run goes on, was killed (there is no `report.json`) or failed. Equally named
models of other directories are not given the directory that holds each other's results.

With `<motion_output/>`, or `mbd run --motion`, the run keeps the motion of all nodes too, in
`motion.bin`; `mbd view` makes a page of it, `view.html`, that shows it in a browser, and
`mbd run --view` does both. A page needs no network and has 20 MB at most (`--size`): if its frames
need more, evenly chosen ones are shown, and where fewer than 50 would fit, resultants, reactions and
velocities are left out. Bodies are drawn as the sphere, cylinder or box that has their mass and
inertias, beams with a round or rectangular section that has their radii of gyration: stiffness says
no more of shapes. `mbd view MODEL` shows a model before a run, also one whose joints do not
close, with its gaps.

The first line of `motion.bin` is JSON, which says how many numbers the blocks of a frame have; frames
of double precision follow (the least byte first): time [s] or load factor; positions [m] and unit
quaternions (x, y, z, w) of the nodes; with a `<transient>` their velocities [m/s] and angular
velocities [rad/s] in node axes; resultants [N, N.m] at the quadrature points of beams, section axes;
and for each joint its angle [rad] and the force [N] and moment [N.m] on b in joint axes. In Python:

```python
file = open("results/tip_deflection/motion.bin", "rb"); head = json.loads(file.readline())
frames = numpy.fromfile(file, "<f8"); frames = frames[:len(frames) // head["row"] * head["row"]].reshape(-1, head["row"])
```

`mbd run --hdf5` keeps the motion too, and writes the whole run to one HDF5 file, `run.h5`: the columns
of the history with their units, labels and axes, the motion, parameters, model, report and
commit. It is for whoever runs a model to ask for; models do not. It may be read while the run goes on,
and after a kill: what is at most half a second older than the run is there, `report` is empty until
the end, and datasets may differ in length by what is being written. Off, HDF5 is not even loaded. In Python, with h5py and pandas (files of runs that came to their end open without `swmr` too):

```python
run = h5py.File("results/tip_deflection/run.h5", swmr=True); n = min(map(len, run["history"].values()))
history = pandas.DataFrame({name: column[:n] for name, column in run["history"].items()})
```

`run["motion"]` has `time` (or `load_factor`), `position`, `quaternion`, `velocity` and `angular_velocity` of the
`nodes`, `force` and `moment` at the quadrature `points`, `joint_angle`, `joint_force` and `joint_moment` of
the `joints`, in the axes above; `run["report"][:].tobytes()` is report.json.

`mbd export DIR --vtk TO` writes the motion that a run has kept for ParaView: `NAME.pvd`, with at most 200
frames unless `--frames` asks for more; `mbd export MODEL --vtk TO` the reference configuration. Centre lines
are Lagrange curves of the order of the beams, through their nodes; quadrature points have resultants and,
but for viscous sections, strains; outlines of sections and solids of bodies are those of the page;
nodes, joints and recorded places at nodes have their axes as vectors, for glyphs, and joints their reactions (inertial
axes; not a number for joints whose bodies are fused to one node). `gap` is the distance between the points of a joint, which
of one that slides is its displacement.

With `--stresses`, beams of one section that is stated by material and shape have them: `stresses` is a solid, the elements of
the section swept from node to node, with `stress` in Pa along section axes (components 11 22 33 12 23 13), `von_mises` in
Pa, and, where a material is not isotropic, `ply_stress` in Pa along the axes of its ply (LL TT NN TN LN LT), all from the
resultants as centre lines have them. The model is read again for them, from where the
run read it or from `--model FILE`, with the `--set` of the run. They leave out what stresses of records leave out; warping is not drawn. Sections by
matrices say nothing of stresses, and one that varies is known at its stations only: such beams have none. A frame has
20000 points at most (some 2 MB), unless elements of a mesh alone are more (then 400000).
)md",
     R"xml(<mbd name="tip_deflection">
  <parameter name="P" value="1"/>
  <section name="strip">
    <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="0.5" inertia="2e-4 1e-4 1e-4"/>
    <damping stiffness_proportional="1e-4"/>
  </section>
  <beam name="b" section="strip" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="4"/>
  <fixed name="clamp" between="ground b.start"/>
  <load at="b.end" force="0 0 -P*sin(20*t)"/>
  <transient duration="0.3" step="1e-3"/>
  <record name="tip" at="b.end" quantities="displacement"/>
  <record name="root" joint="clamp" quantities="reaction_force"/>
  <motion_output frames="31"/>
  <plot title="Tip" y="tip.displacement.3" y_scale="1e3" y_label="deflection [mm]"/>
  <plot title="Root" x="tip.displacement.3" y="root.reaction_force.3"/>
  <expect quantity="tip.displacement.1" of="maximum" value="0" tolerance="1e-6"
          source="the beam only shortens"/>
  <expect quantity="root.reaction_force.3" at="0" value="0" tolerance="1e-9"
          source="at rest" when="P=1"/>
</mbd>
)xml"},
};

}  // namespace

std::span<const Word> functions() { return function_words; }
std::span<const Word> constants() { return constant_words; }
std::string_view opening() { return opening_text; }
std::span<const Chapter> chapters() { return all_chapters; }
std::span<const Group> groups() { return all_groups; }

}  // namespace mbd::manual
