# Written by tools/python/make_stubs.py from the package: change that, not this.
import os
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union

import numpy

# What an attribute of an element may be: numbers, words, or a text as in a model file.
Value = Union[str, int, float, Sequence[Any], numpy.ndarray, None]

__version__: str
has_pages: bool

class Element:
    """One element of a Scene. Its methods add what may stand in it; `help(mbd.Scene.beam)` says what an element has."""
    def __init__(self, scene: Any, line: Any, attributes: Any, content: Any) -> None:
        ...

class Model:
    """A model: a file, a text, or a Scene built in Python.

    path: file name or mbd.Scene
    text: the model itself, in place of a file; `file` is what messages call it
    set: dict, values of parameters in place of the model's: numbers, or texts with a unit ("30 rpm")

    Raises ModelError, with .file and .line, for what models do not allow. What connects its parts is looked at when it
    is first run, stepped or checked.
    """
    def __init__(self, path: Any = None, *, text: Any = None, set: Any = None, file: Any = 'model.xml') -> None:
        ...
    def check(self) -> Dict[str, Any]:
        """dict: what `mbd check --json` says: sizes, mechanism, redundant constraints, gaps, notes."""
        ...
    @property
    def columns(self) -> Dict[str, str]:
        """dict: what a run records, {column: unit}, the first is time [s] or load_factor. Compiles the model."""
        ...
    def explain(self) -> Dict[str, Any]:
        """dict: what `mbd explain --json` says: what is simulated, where it is stated, what is absent and why."""
        ...
    @property
    def file(self) -> str:
        """It was read from, str."""
        ...
    @property
    def name(self) -> str:
        """Of the model, str."""
        ...
    @property
    def parameters(self) -> Dict[str, float]:
        """dict: values of all parameters, SI units."""
        ...
    def run(self, progress: Any = False, *, out: Any = None, method: Any = None, step: Any = None, tolerance: Any = None, output: Any = None, stages: Any = None, without: Any = (), accuracy: Any = None, quantities: Any = (), choose_within: Any = 600.0, motion: Any = False, frames: Any = None, certify: Any = False, estimate_error: Any = True) -> Results:
        """Runs the model as `mbd run` does, to the same bits, and returns Results.

        progress: True shows a line on stderr; or a function f(t, duration, step), called a few times a second
        out: directory for history.csv, history.svg and report.json, and for modes where the model asks for some; none:
        nothing is written
        method, step [s], tolerance, output [s], stages: integrate otherwise than the model says (of a <transient>)
        without: effects to leave out, as `mbd effects` names them
        accuracy: chooses settings for this error of `quantities`, within choose_within [s] of CPU time
        motion: keeps the motion for Results.view(); frames: so many, else one with each row
        certify: makes the dear checks of the certificate too
        estimate_error: estimates the error in time by a second run in other steps

        Runs on a thread of its own without Python's lock. Raises ModelError for what cannot start, RunError for a run
        that ends too early, Interrupted for Ctrl-C; the last two have .results, which are also in Model.results.
        """
        ...
    def stepper(self, *, method: Any = None, step: Any = None, tolerance: Any = None, duration: Any = None) -> Stepper:
        """A Stepper at t = 0, after the equilibrium if the model has a <static>.

        method, step [s], tolerance, duration [s]: otherwise than the model's <transient> says
        """
        ...
    def view(self) -> Page:
        """A page that shows the model, with the gaps of joints that do not close."""
        ...

class Page:
    """One HTML page that loads nothing. A notebook shows it; save() writes it."""
    def __init__(self, html: Any) -> None:
        ...
    def save(self, file: Any) -> Any:
        ...

class Results:
    """What a run has recorded. r["tip.displacement"] is a quantity, r["tip"] all of a record, r["tip.displacement.3"]
    a column; rows are the states of history.csv. Arrays are views that cannot be written to.
    """
    def __contains__(self, name: Any) -> bool:
        ...
    def __getitem__(self, name: str) -> numpy.ndarray:
        """A column, (rows,); or a quantity or a record, (rows, components). Raises UnknownName."""
        ...
    def __init__(self, name: Any, table: Any, report: Any, directory: Any = None, kept: Any = None) -> None:
        ...
    def __iter__(self) -> Iterator[str]:
        ...
    def __len__(self) -> int:
        ...
    @property
    def as_expected(self) -> bool:
        """Complete, and all expectations met."""
        ...
    @property
    def certificate(self) -> Dict[str, Any]:
        """dict: verdict and checks (value, bounds, where) of the run."""
        ...
    @property
    def columns(self) -> List[str]:
        """Names of the columns, list; the first is time or load_factor."""
        ...
    @property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        ...
    @property
    def expectations(self) -> List[Dict[str, Any]]:
        """list of dict: the numbers the model expects, what came, and whether it passes."""
        ...
    @property
    def failure(self) -> str:
        """Why it did not, str; "" if it did."""
        ...
    def frame(self) -> Any:
        """pandas.DataFrame with a column for each column, indexed by time (or load_factor)."""
        ...
    def keys(self) -> List[str]:
        ...
    def plot(self, *names: Any, ax: Any = None) -> Any:
        """Draws records, quantities or columns (none: all) over time by matplotlib; returns the axes, one for each unit,
        or `ax`.
        """
        ...
    @property
    def t(self) -> float:
        """Time reached [s]."""
        ...
    @property
    def time(self) -> numpy.ndarray:
        """The first column: time [s], or load_factor."""
        ...
    @property
    def units(self) -> Dict[str, str]:
        """dict: unit of each column and quantity; "" of a pure number."""
        ...
    @property
    def values(self) -> numpy.ndarray:
        """All numbers, (rows, columns)."""
        ...
    def view(self, frames: Any = None) -> Page:
        """The motion as a page in 3-D, of a run with motion=True; `frames`: at most so many."""
        ...

class Sweep:
    """The table of a sweep: sweep["rpm"] is a parameter, sweep["tip.displacement.3"] a column, (points,); nan where a
    point was not done, for which `status` and `messages` say why.
    """
    def __getitem__(self, name: str) -> numpy.ndarray:
        ...
    def __init__(self, found: Any) -> None:
        ...
    def __len__(self) -> int:
        ...
    @property
    def columns(self) -> List[str]:
        """Names of what was kept, list."""
        ...
    @property
    def csv(self) -> str:
        """The table as `mbd sweep` writes it, str."""
        ...
    def frame(self) -> Any:
        """pandas.DataFrame: a row for each point; parameters (numbers without their unit), status, columns, t, cpu, message."""
        ...
    @property
    def units(self) -> Dict[str, str]:
        """dict: unit of each column; "" of a pure number."""
        ...
    @property
    def values(self) -> numpy.ndarray:
        """All numbers, (points, columns)."""
        ...

class Inputs:
    """Inputs of a Stepper, by name: s.input["torque"] is what it is now, in its unit, and what is assigned is held from now on."""
    def __contains__(self, arg0: Any) -> bool:
        ...
    def __getitem__(self, name: str) -> float:
        ...
    def __iter__(self) -> Iterator:
        ...
    def __len__(self) -> int:
        ...
    def keys(self) -> list:
        """Names of the inputs."""
        ...

class Scene(Element):
    """A model built in Python, with the names of model files: scene.beam(name="b", from_=(0, 0, 0), …). Values are
    numbers, sequences or arrays of them, or texts as in files (expressions, numbers with units). Attributes `from`
    and `yield` are written from_ and yield_. What has parts returns an Element to which they are added:

        section = scene.section(name="strip")
        section.stiffness(EA=1e6, GA2=4e5, GA3=4e5, GJ=80, EI2=100, EI3=100)

    mbd.Model(scene, set={…}) checks it: a ModelError has the Python file and line that stated the item.
    """
    def __init__(self, name: Any, **attributes: Any) -> None:
        ...
    def run(self, set: Any = None, **options: Any) -> Results:
        """mbd.Model(self, set=set).run(…)."""
        ...
    def xml(self) -> str:
        """The same as a model file, str."""
        ...
    def parameter(self, *, name: Value = None, value: Value = None) -> ParameterElement:
        """<parameter>
          A named number. Later expressions may use it; --set replaces its value.
          Stands in <mbd>.

        Attributes:
          name               name, required
                             a word that expressions below may use
          value              number [any unit], required
                             its value, unless --set gives another; with a unit it is
                             converted to SI units and rad

        For example:
          <mbd name="balls" version="1">
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
        """
        ...
    def include(self, *, file: Value = None) -> IncludeElement:
        """<include>
          Reads the elements of another model file here, as if they stood in this one.
          That file's name for its model is not used.
          Stands in <mbd>.

        Attributes:
          file               text, required
                             its name, relative to the file that includes it

        For example:
          <mbd name="springboard">
            <include file="tubes.xml"/>
            <beam name="board" section="tube40" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2"/>
            <fixed name="wall" between="ground board.start"/>
            <load at="board.end" force="0 0 0.01>t?-200:0 N"/>
            <transient duration="50 ms" step="0.5 ms"/>
            <record name="tip" at="board.end" quantities="displacement"/>
          </mbd>
        """
        ...
    def defaults(self) -> DefaultsElement:
        """<defaults>
          Elements with some of their attributes, no name and no content: what later
          elements of that kind have when they do not say otherwise.
          Stands in <mbd>. Holds <material>, <layup>, <ply>, <section>, <station>,
          <stiffness>, <mass>, <damping>, <tube>, <bar>, <rectangle>, <box>, <I>, <C>,
          <mesh>, <region>, <airfoil>, <sector>, <web>, <beam>, <arc>, <curve>, <point>,
          <body>, <shape>, <drive>, <motion>, <load>, <distributed>, <rigid>,
          <point_mass>, <spring>, <bushing>, <joint_spring>, <joint_torque>, <drag>,
          <added_mass>, <extension>, <base_motion>, <gravity>, <static>, <path>, <mark>,
          <stop>, <transient>, <modes>, <record>, <motion_output>, <plot>, <expect>,
          <input>, <function>, <controller>, <reduction>, <fixed>, <rigid_link>,
          <revolute>, <prismatic>, <cylindrical>, <screw>, <universal>, <spherical>,
          <planar>, <point_on_line>, <distance>.

        For example:
          <mbd name="balls" version="1">
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
        """
        ...
    def material(self, *, name: Value = None, E: Value = None, nu: Value = None, EL: Value = None, ET: Value = None, EN: Value = None, GLT: Value = None, GLN: Value = None, GTN: Value = None, nuLT: Value = None, nuLN: Value = None, nuTN: Value = None, rho: Value = None, yield_: Value = None, Xt: Value = None, Xc: Value = None, Yt: Value = None, Yc: Value = None, SLT: Value = None, STN: Value = None, Zt: Value = None, Zc: Value = None, SLN: Value = None) -> MaterialElement:
        """<material>
          A linear elastic material, of which sections are made: isotropic by E and nu;
          else along its axes, L along the fibres, N across the ply, T = N x L, by EL,
          ET, GLT, nuLT, nuTN, and what differs along N.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name plies and sections refer to
          E                  number > 0 [Pa], optional
                             Young's modulus of an isotropic material
          nu                 number, optional
                             Poisson's ratio of an isotropic material, between -1 and
                             0.5
          EL                 number > 0 [Pa], optional
                             Young's modulus along L, the fibres
          ET                 number > 0 [Pa], optional
                             along T
          EN                 number > 0 [Pa], optional
                             along N (default: ET)
          GLT                number > 0 [Pa], optional
                             shear modulus in the ply
          GLN                number > 0 [Pa], optional
                             of L and N (default: GLT)
          GTN                number > 0 [Pa], optional
                             of T and N (default: ET/(2 (1 + nuTN)))
          nuLT               number, optional
                             contraction along T by a stress along L; nuLT/EL = nuTL/ET
          nuLN               number, optional
                             contraction along N by a stress along L (default: nuLT)
          nuTN               number, optional
                             contraction along N by a stress along T
          rho                number > 0 [kg/m3], optional
                             density; without one, sections of it have no mass
          yield              number > 0 [Pa], optional
                             yield stress of an isotropic material, for the quantity
                             yield_index
          Xt                 number > 0 [Pa], optional
                             strength along L, the fibres, in tension
          Xc                 number > 0 [Pa], optional
                             along L in compression, as a positive number
          Yt                 number > 0 [Pa], optional
                             along T in tension
          Yc                 number > 0 [Pa], optional
                             along T in compression, positive
          SLT                number > 0 [Pa], optional
                             in shear in the ply
          STN                number > 0 [Pa], optional
                             in shear of T and N
          Zt                 number > 0 [Pa], optional
                             along N in tension (default: Yt)
          Zc                 number > 0 [Pa], optional
                             along N in compression (default: Yc)
          SLN                number > 0 [Pa], optional
                             in shear of L and N (default: SLT)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def layup(self, *, name: Value = None, listed: Value = None) -> LayupElement:
        """<layup>
          The plies of a wall, one after the other.
          Stands in <mbd>, <repeat>, <defaults>. Holds <ply>, <repeat>.

        Attributes:
          name               name, required
                             name sections refer to
          listed             inside or outside, default inside
                             from the inside, the first ply is the innermost one; or
                             from the outside. Angles are about the outward normal in
                             both cases

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def section(self, *, name: Value = None, interpolation: Value = None) -> SectionElement:
        """<section>
          Stiffness and mass of a cross-section, axes b1 (along the beam) b2 b3.
          Stands in <mbd>, <repeat>, <defaults>. Holds <station>, <stiffness>, <mass>,
          <damping>, <tube>, <bar>, <rectangle>, <box>, <I>, <C>, <mesh>, <airfoil>,
          <repeat>.

        Attributes:
          name               name, required
                             name beams refer to
          interpolation      linear or smooth, default linear
                             between stations, entry by entry: linear (kinks are best
                             placed at ends of elements) or a cubic spline

        For example:
          <mbd name="mast">
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
        """
        ...
    def beam(self, *, name: Value = None, section: Value = None, from_: Value = None, to: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> BeamElement:
        """<beam>
          A straight beam.
          Stands in <mbd>, <repeat>, <defaults>. Holds <shape>.

        Attributes:
          name               name, required
                             name, unique among beams and bodies
          section            text, required
                             name of its section
          from               3 numbers [m], required
                             start of the reference line
          to                 3 numbers [m], required
                             end of the reference line
          normal             3 numbers, required
                             b3 at the start (of a curve: everywhere); its part along
                             the reference line does not matter
          elements           whole number from 1 to 1000000, default 1
                             spectral elements of equal length, of the beam or (mesh) of
                             each of its parts
          mesh               equal or stations, default equal
                             what `elements` divides: the beam, or each part between two
                             stations of its section, where kinks of its tables are then
                             ends of elements
          order              whole number from 1 to 8, default 3
                             order N: N + 1 nodes an element
          kinematics         motion or classical, default motion
                             what is interpolated: the motion, or (classical)
                             displacement and rotation apart, without metric and form
          metric             matrix, quaternion or geodesic, default geodesic
                             interpolation of motion
          rule               gauss or gauss_lobatto, default gauss
                             quadrature; gauss_lobatto locks
          form               energy or paper, default energy
                             elastic force: gradient of a discrete energy, or the
                             paper's

        For example:
          <mbd name="hook">
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
        """
        ...
    def arc(self, *, name: Value = None, section: Value = None, from_: Value = None, center: Value = None, axis: Value = None, angle: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> ArcElement:
        """<arc>
          A beam along a circular arc: `from`, turned about the centre.
          Stands in <mbd>, <repeat>, <defaults>. Holds <shape>.

        Attributes:
          name               name, required
                             name, unique among beams and bodies
          section            text, required
                             name of its section
          from               3 numbers [m], required
                             start of the reference line
          center             3 numbers [m], required
                             centre of the circle
          axis               3 numbers, required
                             the line runs right-handed about it
          angle              number > 0 [rad], required
                             subtended angle
          normal             3 numbers, required
                             b3 at the start (of a curve: everywhere); its part along
                             the reference line does not matter
          elements           whole number from 1 to 1000000, default 1
                             spectral elements of equal length, of the beam or (mesh) of
                             each of its parts
          mesh               equal or stations, default equal
                             what `elements` divides: the beam, or each part between two
                             stations of its section, where kinks of its tables are then
                             ends of elements
          order              whole number from 1 to 8, default 3
                             order N: N + 1 nodes an element
          kinematics         motion or classical, default motion
                             what is interpolated: the motion, or (classical)
                             displacement and rotation apart, without metric and form
          metric             matrix, quaternion or geodesic, default geodesic
                             interpolation of motion
          rule               gauss or gauss_lobatto, default gauss
                             quadrature; gauss_lobatto locks
          form               energy or paper, default energy
                             elastic force: gradient of a discrete energy, or the
                             paper's

        For example:
          <mbd name="hook">
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
        """
        ...
    def curve(self, *, name: Value = None, section: Value = None, degree: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> CurveElement:
        """<curve>
          A beam along a smooth curve through points.
          Stands in <mbd>, <repeat>, <defaults>. Holds <point>, <shape>, <repeat>.

        Attributes:
          name               name, required
                             name, unique among beams and bodies
          section            text, required
                             name of its section
          degree             whole number from 1 to 1000, optional
                             of the spline (default: 2 order + 1, or what the points
                             allow; lower it for rough points)
          normal             3 numbers, required
                             b3 at the start (of a curve: everywhere); its part along
                             the reference line does not matter
          elements           whole number from 1 to 1000000, default 1
                             spectral elements of equal length, of the beam or (mesh) of
                             each of its parts
          mesh               equal or stations, default equal
                             what `elements` divides: the beam, or each part between two
                             stations of its section, where kinks of its tables are then
                             ends of elements
          order              whole number from 1 to 8, default 3
                             order N: N + 1 nodes an element
          kinematics         motion or classical, default motion
                             what is interpolated: the motion, or (classical)
                             displacement and rotation apart, without metric and form
          metric             matrix, quaternion or geodesic, default geodesic
                             interpolation of motion
          rule               gauss or gauss_lobatto, default gauss
                             quadrature; gauss_lobatto locks
          form               energy or paper, default energy
                             elastic force: gradient of a discrete energy, or the
                             paper's

        For example:
          <mbd name="hook">
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
        """
        ...
    def body(self, *, name: Value = None, attached_to: Value = None, at: Value = None, orientation: Value = None, mass: Value = None, center: Value = None, inertia: Value = None, velocity: Value = None, angular_velocity: Value = None) -> BodyElement:
        """<body>
          A rigid body, free or fixed to a place.
          Stands in <mbd>, <repeat>, <defaults>. Holds <shape>.

        Attributes:
          name               name, required
                             name, unique among beams and bodies
          attached_to        place, optional
                             the place it is fixed to; its axes are those of the place
          at                 3 numbers [m], optional
                             reference point of a free body (default 0 0 0)
          orientation        3 or 9 numbers [rad], optional
                             of a free body: rotation vector, or (without unit) matrix
                             row by row
          mass               number >= 0 [kg], optional
                             mass; only a body whose <shape> has a density, or on the
                             ground, may leave it out
          center             3 numbers [m], default 0 0 0
                             mass centre from the reference point, body axes
          inertia            3 or 6 numbers [kg.m2], optional
                             matrix xx yy zz [xy xz yz] about the mass centre, body
                             axes; left out with the mass
          velocity           3 numbers [m/s], optional
                             of the reference point of a free body at the start,
                             inertial axes (default 0 0 0)
          angular_velocity   3 numbers [rad/s], optional
                             of a free body at the start, body axes (default 0 0 0)

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...
    def drive(self, *, joint: Value = None, rate: Value = None, angle: Value = None, speed: Value = None, displacement: Value = None) -> DriveElement:
        """<drive>
          Prescribes the angle or the displacement of a joint.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          joint              text, required
                             name of a joint with an angle or a displacement
          rate               expression of t [rad/s], optional
                             rotation rate of b relative to a; the angle starts at 0
          angle              expression of t [rad], optional
                             or the rotation of b relative to a, 0 at the start
          speed              expression of t [m/s], optional
                             or the speed of b relative to a along the axis; the
                             displacement starts at 0
          displacement       expression of t [m], optional
                             or the displacement of b relative to a along the axis, 0 at
                             the start

        For example:
          <mbd name="wiper">
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
        """
        ...
    def motion(self, *, name: Value = None, of: Value = None, displacement: Value = None, velocity: Value = None, rotation: Value = None, axis: Value = None, angle: Value = None, rate: Value = None) -> MotionElement:
        """<motion>
          Prescribes the motion of a place; what is not given is free.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints and motions
          of                 place, required
                             the place that moves
          displacement       3 expressions of t [m], optional
                             from the reference configuration, inertial axes, 0 at the
                             start
          velocity           3 expressions of t [m/s], optional
                             or its rate; the displacement starts at 0
          rotation           3 expressions of t [rad], optional
                             rotation vector from the reference configuration, inertial
                             axes, of any length
          axis               3 numbers, optional
                             or an inertial axis, and one of angle and rate
          angle              expression of t [rad], optional
                             rotation about the axis, 0 at the start
          rate               expression of t [rad/s], optional
                             or its rate; the angle starts at 0

        For example:
          <mbd name="wiper">
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
        """
        ...
    def load(self, *, name: Value = None, at: Value = None, force: Value = None, moment: Value = None, follower_force: Value = None, follower_moment: Value = None, offset: Value = None) -> LoadElement:
        """<load>
          A force and moment at a place.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, optional
                             name, for messages
          at                 place, required
                             where it acts
          force              3 expressions of t [N], optional
                             dead force, inertial axes
          moment             3 expressions of t [N.m], optional
                             dead moment, inertial axes
          follower_force     3 expressions of t [N], optional
                             force in the axes of the section or body
          follower_moment    3 expressions of t [N.m], optional
                             moment in the axes of the section or body
          offset             3 numbers [m], default 0 0 0
                             where the forces act, from the place, in the axes of the
                             section or body

        For example:
          <mbd name="beam_in_wind">
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
        """
        ...
    def distributed(self, *, name: Value = None, beam: Value = None, from_: Value = None, to: Value = None, force: Value = None, moment: Value = None, follower_force: Value = None, follower_moment: Value = None) -> DistributedElement:
        """<distributed>
          Forces and moments per unit of reference length along a beam; expressions of
          s, the fraction of that length, and t.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, optional
                             name, for messages
          beam               text, required
                             name of the beam
          from               number from 0 to 1, default 0
                             where it begins, fraction of the reference length
          to                 number from 0 to 1, default 1
                             where it ends
          force              3 expressions of s, t [N/m], optional
                             dead force per reference length, inertial axes
          moment             3 expressions of s, t [N], optional
                             dead moment per reference length, inertial axes
          follower_force     3 expressions of s, t [N/m], optional
                             force per reference length, section axes
          follower_moment    3 expressions of s, t [N], optional
                             moment per reference length, section axes

        For example:
          <mbd name="beam_in_wind">
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
        """
        ...
    def rigid(self, *, name: Value = None, of: Value = None) -> RigidElement:
        """<rigid>
          Makes one rigid body of beams and free bodies: one node with the mass of them
          all. Places of its beams stay places; joints between two of them do nothing.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among beams, bodies and rigid ones
          of                 words, required
                             names of beams and free bodies; its frame is the first
                             one's

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...
    def point_mass(self, *, name: Value = None, at: Value = None, mass: Value = None, offset: Value = None) -> PointMassElement:
        """<point_mass>
          A mass without inertia of its own that moves with a place.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, optional
                             name, for messages
          at                 place, required
                             what it moves with
          mass               number >= 0 [kg], required
                             mass
          offset             3 numbers [m], default 0 0 0
                             from the place, axes of the section or body

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...
    def spring(self, *, name: Value = None, between: Value = None, at_a: Value = None, at_b: Value = None, stiffness: Value = None, damping: Value = None, length: Value = None, force: Value = None, damping_force: Value = None) -> SpringElement:
        """<spring>
          A spring, a damper or both along the line between two points of two places.
          Stands in <mbd>, <repeat>, <defaults>. Holds <table>.

        Attributes:
          name               name, required
                             name, unique among springs
          between            two places, required
                             the two places a and b it acts on
          at_a               3 numbers [m], optional
                             its point of a (default: that of the place)
          at_b               3 numbers [m], optional
                             its point of b (default: that of the place)
          stiffness          number >= 0 [N/m], optional
                             tension per extension x
          damping            number >= 0 [N.s/m], optional
                             tension per rate v of the length
          length             number >= 0 [m], optional
                             free length, where x = 0 (default: that of the reference
                             configuration)
          force              expression of x [N], optional
                             or (both add up) the tension at the extension x [m]
          damping_force      expression of v [N], optional
                             or (both add up) the tension at the rate v [m/s]; 0 at v =
                             0

        For example:
          <mbd name="gate">
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
        """
        ...
    def bushing(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, second_axis: Value = None, stiffness: Value = None, angular_stiffness: Value = None, damping: Value = None, angular_damping: Value = None) -> BushingElement:
        """<bushing>
          An elastic connection of two frames, which coincide in the reference
          configuration, in all six directions.
          Stands in <mbd>, <repeat>, <defaults>. Holds <matrix>, <law>.

        Attributes:
          name               name, required
                             name, unique among springs
          between            two places, required
                             the two places a and b it connects
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, optional
                             its third axis (default: inertial axes)
          second_axis        3 numbers, optional
                             its first axis, perpendicular to the third (default: any)
          stiffness          3 numbers, each >= 0 [N/m], optional
                             along its three axes
          angular_stiffness  3 numbers, each >= 0 [N.m], optional
                             about its three axes, per rad
          damping            3 numbers, each >= 0 [N.s/m], optional
                             along its three axes
          angular_damping    3 numbers, each >= 0 [N.m.s], optional
                             about its three axes, per rad

        For example:
          <mbd name="gate">
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
        """
        ...
    def joint_spring(self, *, name: Value = None, joint: Value = None, angular_stiffness: Value = None, angular_damping: Value = None, rest_angle: Value = None, moment: Value = None, damping_moment: Value = None, stiffness: Value = None, damping: Value = None, rest_displacement: Value = None, force: Value = None, damping_force: Value = None) -> JointSpringElement:
        """<joint_spring>
          A spring, a damper or both on the free coordinate of a joint: its angle, over
          any number of turns, or its displacement.
          Stands in <mbd>, <repeat>, <defaults>. Holds <table>.

        Attributes:
          name               name, required
                             name, unique among springs
          joint              text, required
                             name of a joint with an angle or a displacement
          angular_stiffness  number >= 0 [N.m], optional
                             moment per angle of b relative to a, against it
          angular_damping    number >= 0 [N.m.s], optional
                             moment per rate of the angle
          rest_angle         number [rad], optional
                             angle without moment (default 0)
          moment             expression of x [N.m], optional
                             or (both add up) the moment at x [rad], the angle less
                             rest_angle, against it
          damping_moment     expression of v [N.m], optional
                             or (both add up) the moment at the rate v [rad/s]; 0 at v =
                             0
          stiffness          number >= 0 [N/m], optional
                             or force per displacement of b relative to a along the
                             axis, against it
          damping            number >= 0 [N.s/m], optional
                             force per speed
          rest_displacement  number [m], optional
                             displacement without force (default 0)
          force              expression of x [N], optional
                             or (both add up) the force at x [m], the displacement less
                             rest_displacement, against it
          damping_force      expression of v [N], optional
                             or (both add up) the force at the speed v [m/s]; 0 at v = 0

        For example:
          <mbd name="gate">
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
        """
        ...
    def joint_torque(self, *, name: Value = None, joint: Value = None, moment: Value = None, force: Value = None) -> JointTorqueElement:
        """<joint_torque>
          A moment about or a force along the axis of a joint, of time; the joint turns
          freely.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, optional
                             name, for messages
          joint              text, required
                             name of a joint with an angle or a displacement
          moment             expression of t [N.m], optional
                             on b about the axis, and its opposite on a
          force              expression of t [N], optional
                             on b along the axis, and its opposite on a

        For example:
          <mbd name="gate">
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
        """
        ...
    def drag(self, *, name: Value = None, density: Value = None, flow: Value = None, beam: Value = None, from_: Value = None, to: Value = None, diameter: Value = None, normal_coefficient: Value = None, tangential_coefficient: Value = None, at: Value = None, area: Value = None, coefficient: Value = None, offset: Value = None) -> DragElement:
        """<drag>
          Quadratic drag of a fluid, still or flowing, along a beam or at a place.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, optional
                             name, for messages
          density            number > 0 [kg/m3], required
                             of the fluid
          flow               3 expressions of t [m/s], optional
                             velocity of the fluid, inertial axes; without it the fluid
                             is still
          beam               text, optional
                             name of the beam (one of beam, at)
          from               number from 0 to 1, optional
                             of a beam: where it begins, fraction of the reference
                             length (default 0)
          to                 number from 0 to 1, optional
                             of a beam: where it ends (default 1)
          diameter           number > 0 [m], optional
                             of a beam, which needs it
          normal_coefficient number >= 0, optional
                             of a beam, which needs it: C of 1/2 density C diameter |u|
                             u per length, u across the beam
          tangential_coefficient number >= 0, optional
                             of a beam, which needs it: C of 1/2 density C pi diameter
                             |u| u per length, u along the beam
          at                 place, optional
                             or what it acts on (one of beam, at)
          area               number > 0 [m2], optional
                             at a place, which needs it
          coefficient        number >= 0, optional
                             at a place, which needs it: C of 1/2 density C area |u| u,
                             the same in all directions
          offset             3 numbers [m], optional
                             at a place: where it acts, from there, axes of the section
                             or body (default 0 0 0)

        For example:
          <mbd name="pier">
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
        """
        ...
    def added_mass(self, *, name: Value = None, beam: Value = None, from_: Value = None, to: Value = None, density: Value = None, diameter: Value = None, coefficient: Value = None, at: Value = None, matrix: Value = None) -> AddedMassElement:
        """<added_mass>
          Inertia of a fluid that a beam or a body sets in motion: of a fluid at rest,
          without its weight.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, optional
                             name, for messages
          beam               text, optional
                             name of the beam (one of beam, at)
          from               number from 0 to 1, optional
                             of a beam: where it begins, fraction of the reference
                             length (default 0)
          to                 number from 0 to 1, optional
                             of a beam: where it ends (default 1)
          density            number > 0 [kg/m3], optional
                             of a beam, which needs it: of the fluid
          diameter           number > 0 [m], optional
                             of a beam, which needs it
          coefficient        number >= 0, optional
                             of a beam, which needs it: C of density C pi diameter^2/4
                             per length, across the beam; along it there is none
          at                 place, optional
                             or what it moves with (one of beam, at)
          matrix             6 or 21 numbers, optional
                             at a place, which needs it, in SI units: m11 m22 m33 [kg]
                             J11 J22 J33 [kg.m2], or the upper triangle row by row (21
                             numbers), of velocities v1 v2 v3 and angular velocities w1
                             w2 w3 in the axes of the section or body

        For example:
          <mbd name="pier">
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
        """
        ...
    def extension(self, *, name: Value = None, force: Value = None, at: Value = None, values: Value = None) -> ExtensionElement:
        """<extension>
          A force that a plug-in computes, as `mbd run --plugin FILE` gives it
          (libmbd/plugin.h).
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, optional
                             name, for messages
          force              text, required
                             what its plug-in calls it
          at                 words, required
                             what it acts on, in the order its plug-in wants: places
                             with a node, or beams, which stand for all of their nodes
          values             text, optional
                             numbers for it: name=expression, separated by blanks, which
                             expressions do not contain, in SI units

        For example:
          <mbd name="servo_arm">
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
        """
        ...
    def base_motion(self, *, acceleration: Value = None, velocity: Value = None, displacement: Value = None) -> BaseMotionElement:
        """<base_motion>
          Accelerates the ground without turning it; everything else is relative to the
          ground.
          Stands in <mbd>, <defaults>.

        Attributes:
          acceleration       3 expressions of t [m/s2], optional
                             of the base, inertial axes (one of three)
          velocity           3 expressions of t [m/s], optional
                             or its velocity, continuous
          displacement       3 expressions of t [m], optional
                             or its displacement, continuous with its rate

        For example:
          <mbd name="pier">
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
        """
        ...
    def gravity(self, *, acceleration: Value = None) -> GravityElement:
        """<gravity>
          Uniform gravity on everything that has mass.
          Stands in <mbd>, <defaults>.

        Attributes:
          acceleration       3 numbers [m/s2], required
                             of free fall, inertial axes

        For example:
          <mbd name="beam_in_wind">
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
        """
        ...
    def static(self, *, steps: Value = None, tolerance: Value = None, solver: Value = None, line_search: Value = None, linear_solver: Value = None) -> StaticElement:
        """<static>
          Static equilibrium at t = 0, before the transient if there is one.
          Stands in <mbd>, <defaults>.

        Attributes:
          steps              whole number from 1 to 1000000, default 1
                             the first load step is 1/steps of all loads
          tolerance          number > 0, default 1e-12
                             of Newton's increments, relative
          solver             newton or kinsol, default newton
                             of each load step: our Newton iterations, or KINSOL's with
                             its line search
          line_search        off or on, default on
                             of Newton's iterations: increments that do not bring
                             equilibrium nearer are shortened
          linear_solver      block or klu, default block
                             block LU along the graph of nodes and joints, with KLU
                             where that has no good pivots; or KLU alone

        For example:
          <mbd name="released">
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
        """
        ...
    def path(self, *, method: Value = None, direction: Value = None, step: Value = None, max_step: Value = None, points: Value = None, length: Value = None, branch: Value = None, tolerance: Value = None) -> PathElement:
        """<path>
          Follows the equilibria over the load factor, from 0, through limit points and
          bifurcations; instead of <static> and <transient>.
          Stands in <mbd>, <defaults>. Holds <mark>, <stop>.

        Attributes:
          method             bordered or crisfield, default bordered
                             predictor and corrector on the bordered system, or
                             Crisfield's cylindrical arc length
          direction          forward, backward or both, default forward
                             of the load factor at the start: growing, falling, or first
                             one and then the other
          step               number > 0, default 0.05
                             first step, of the load factor
          max_step           number > 0, default 0.1
                             longest step: rms over the nodes of displacement (over the
                             scene's size) and rotation [rad]
          points             whole number from 1 to 1000000, default 200
                             most points of each branch
          length             number > 0, optional
                             most arc length of each branch, measured as max_step
          branch             whole number from -1000000 to 1000000, default 0
                             number of the bifurcation whose other branch is followed
                             too; negative: to its other side; 0: none
          tolerance          number from 1e-15 to 1e-08, default 1e-12
                             of the corrector's increments, relative

        For example:
          <mbd name="snap_through">
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
        """
        ...
    def transient(self, *, duration: Value = None, method: Value = None, step: Value = None, tolerance: Value = None, position_tolerance: Value = None, rotation_tolerance: Value = None, velocity_tolerance: Value = None, angular_velocity_tolerance: Value = None, errors: Value = None, stages: Value = None, max_step: Value = None, output: Value = None, rho_infinity: Value = None, balance: Value = None, newton_tolerance: Value = None, inertia: Value = None, linear_solver: Value = None) -> TransientElement:
        """<transient>
          Integration in time, in fixed steps or in steps that follow an estimated
          error.
          Stands in <mbd>, <defaults>.

        Attributes:
          duration           number > 0 [s], required
                             simulated time; of fixed steps, a whole number of them
          method             generalized_alpha, radau or ida, default generalized_alpha
                             integrator: of order 2; Radau IIA, of order 5; or IDA of
                             SUNDIALS, of variable order
          step               number > 0 [s], optional
                             time step, of fixed steps (one of step, tolerance)
          tolerance          number from 1e-14 to 0.1, optional
                             or the relative error that steps are chosen for: of lengths
                             of the scene, of radians, and of the fastest velocities
          position_tolerance number > 0 [m], optional
                             in place of the relative one, of positions
          rotation_tolerance number > 0 [rad], optional
                             the same, of rotations
          velocity_tolerance number > 0 [m/s], optional
                             the same, of velocities; not of generalized_alpha, which
                             does not estimate them
          angular_velocity_tolerance number > 0 [rad/s], optional
                             the same, of angular velocities
          errors             motion or velocities, optional
                             of radau with a tolerance: which errors steps are held by,
                             those of positions and rotations, relative to the largest
                             motion so far, or of velocities as well (default: motion
                             where all that is recorded follows from it, else
                             velocities)
          stages             auto, 3, 5 or 7, optional
                             of radau: how many stages a step has, for order 5, 9 or 13,
                             or chosen as it goes by what comes farthest for its work
                             (default: auto; 3 of fixed steps)
          max_step           number > 0 [s], optional
                             longest step that a tolerance may lead to (default: a part
                             of the duration)
          output             number > 0, or steps [s], optional
                             time between rows of results, or steps: where steps end,
                             and at the times of expected values (default: where fixed
                             steps end; with a tolerance, a thousandth of the duration)
          rho_infinity       number from 0 to 1, default 0
                             of generalized_alpha: spectral radius at infinite
                             frequency; 0 damps most, 1 nothing
          balance            acceleration or momentum, optional
                             of inertia, of generalized_alpha: accelerations in body
                             axes, or momenta of every node in inertial axes (default:
                             acceleration, and each part that nothing ties to the
                             ground, without added mass, keeps its momenta as a whole to
                             the tolerance of Newton's iterations)
          newton_tolerance   number > 0, optional
                             of Newton's increments, relative (default: the integrator's
                             own)
          inertia            full or no_gyroscopic, default full
                             its terms: all, or without the gyroscopic moment w x J w
                             about the mass centre of what moves with a node
          linear_solver      block or klu, default block
                             block LU along the graph of nodes and joints, with KLU
                             where that has no good pivots; or KLU alone, which ida
                             always has

        For example:
          <mbd name="released">
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
        """
        ...
    def modes(self, *, count: Value = None, near: Value = None, rate: Value = None, at: Value = None, axis: Value = None, through: Value = None, at_rest: Value = None, mac: Value = None) -> ModesElement:
        """<modes>
          Modes of small motions: frequencies, damping and shapes, in modes.csv and
          modes.json beside the results of a run. `mbd modes` has options of the same
          names, which hold before these attributes.
          Stands in <mbd>, <defaults>.

        Attributes:
          count              whole number from 1 to 10000, default 10
                             how many
          near               number >= 0 [Hz], default 0
                             those nearest to this frequency
          rate               number [rad/s], optional
                             about steady rotation of the whole at this rate (default:
                             about equilibrium)
          at                 number >= 0 [s], optional
                             about the state of a run at this time: what small motions
                             are at that moment
          axis               3 numbers, default 1 0 0
                             axis of the rotation
          through            3 numbers [m], default 0 0 0
                             a point of it
          at_rest            words, optional
                             bodies and flexible beams that do not turn, as the housing
                             of a bearing
          mac                off or on, default off
                             how alike the modes are, weighted by mass, in mac.csv and
                             mac.json: modal assurance criterion

        For example:
          <mbd name="fork">
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
        """
        ...
    def record(self, *, name: Value = None, at: Value = None, joint: Value = None, spring: Value = None, section_point: Value = None, quantities: Value = None) -> RecordElement:
        """<record>
          Columns of history.csv.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             first part of its columns in history.csv
          at                 place, optional
                             a place; without place, joint and spring: the whole system
          joint              text, optional
                             name of a joint or a motion (one of at, joint, spring)
          spring             text, optional
                             name of a spring, a bushing or a joint_spring
          section_point      2 numbers [m], optional
                             of a place of a beam: x2 x3 along b2 b3 from the reference
                             line, of stresses and strains of a section that is stated
                             by material
          quantities         words, required
                             what to write, separated by blanks

        Quantities of a place:
          position               [m] 3 columns, inertial axes
          displacement           [m] 3 columns, from the reference configuration,
                                 inertial axes
          displacement_local     [m] 3 columns, the same, in the present axes of the
                                 section or body
          rotation               [rad] 3 columns, rotation vector from the reference
                                 configuration, inertial axes
          velocity               [m/s] 3 columns, inertial axes
          velocity_local         [m/s] 3 columns, the same, in the present axes of the
                                 section or body
          angular_velocity       [rad/s] 3 columns, inertial axes
          angular_velocity_local [rad/s] 3 columns, the same, in the present axes of the
                                 section or body
          acceleration           [m/s2] 3 columns, inertial axes
          force                  [N] 3 columns, resultants N1 Q2 Q3 of a beam, section
                                 axes; where elements meet under a load or mass, the
                                 mean of both sides
          moment                 [N.m] 3 columns, resultants M1 M2 M3 of a beam, section
                                 axes; as of force
          ply_stress             [Pa] 3 columns, normal stresses LL TT NN at the
                                 record's point, axes of its ply
          ply_shear_stress       [Pa] 3 columns, shear stresses TN LN LT there, axes of
                                 its ply
          ply_strain             [] 3 columns, strains LL TT NN there, axes of its ply
          ply_shear_strain       [] 3 columns, shear strains there, axes of its ply:
                                 changes of the angles TN LN LT
          von_mises              [Pa] stress of von Mises there
          yield_index            [] that over the yield stress of an isotropic material
          max_stress             [] failure index there, the largest of the stresses
                                 over their strengths; of this and the next three: 1 is
                                 failure, and it grows in proportion to the load
          tsai_hill              [] failure index of Tsai and Hill there
          tsai_wu                [] failure index of Tsai and Wu there
          hashin                 [] failure index of Hashin there, of fibres and matrix
                                 the larger one

        Quantities of a joint or a motion:
          angle                  [rad] rotation of b relative to a, unwrapped
          rate                   [rad/s] rotation rate of b relative to a
          displacement           [m] of b relative to a along the axis
          speed                  [m/s] of b relative to a along the axis
          reaction_force         [N] 3 columns, of the joint (with its drives) or motion
                                 on b, joint axes that move with b
          reaction_moment        [N.m] 3 columns, the same, about the joint's point of
                                 b, joint axes that move with b

        Quantities of a spring:
          tension                [N] of a spring with its damper, positive where it
                                 pulls
          length                 [m] of a spring: the distance of its points
          length_rate            [m/s] of a spring: the rate of the length
          force                  [N] 3 columns, of a bushing with its damping on b, axes
                                 of its frame on b
          moment                 [N.m] 3 columns, the same, about the bushing's point of
                                 b
          joint_moment           [N.m] of a joint spring with its damper on b about the
                                 axis
          joint_force            [N] of a joint spring with its damper on b along the
                                 axis

        Quantities of the whole system:
          linear_momentum        [N.s] 3 columns, of everything, added mass included,
                                 inertial axes
          angular_momentum       [N.m.s] 3 columns, the same about the inertial origin,
                                 inertial axes
          kinetic_energy         [J] of everything, added mass included
          strain_energy          [J] of all beams, springs and bushings
          potential_energy       [J] of gravity, zero at the inertial origin
          total_energy           [J] kinetic, strain and potential
          work_of_loads          [J] since the start of the <transient>, gravity
                                 excepted; 0 without
          work_of_drives         [J] of drives and motions since the start of the
                                 <transient>
          work_of_damping        [J] of damping, dampers and drag since the start:
                                 negative, or 0; of drag in a flow, of either sign

        For example:
          <mbd name="tip_deflection">
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
        """
        ...
    def motion_output(self, *, frames: Value = None) -> MotionOutputElement:
        """<motion_output>
          Keeps the motion of every node, resultants along beams and reactions of joints
          in motion.bin, for `mbd view`. Without it nothing is kept, and `mbd run
          --motion` does the same for any model.
          Stands in <mbd>, <defaults>.

        Attributes:
          frames             whole number from 2 to 1000000, optional
                             of a <transient>: so many frames at equal times, the first
                             at the start and the last at the end (default: one with
                             each row of history.csv)

        For example:
          <mbd name="tip_deflection">
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
        """
        ...
    def plot(self, *, x: Value = None, y: Value = None, x_scale: Value = None, y_scale: Value = None, x_label: Value = None, y_label: Value = None, title: Value = None, x_range: Value = None) -> PlotElement:
        """<plot>
          A panel of history.svg.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          x                  text, optional
                             a column of history.csv (default: the first, time or
                             load_factor)
          y                  words, required
                             columns of history.csv, one curve each
          x_scale            number, default 1
                             factor on x
          y_scale            number, default 1
                             factor on y
          x_label            text, optional
                             default: the column and its unit
          y_label            text, optional
                             default: the column and its unit
          title              text, optional
                             written above the panel
          x_range            2 numbers, optional
                             ends of the x axis, scaled

        For example:
          <mbd name="tip_deflection">
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
        """
        ...
    def expect(self, *, quantity: Value = None, of: Value = None, number: Value = None, at: Value = None, value: Value = None, tolerance: Value = None, source: Value = None, when: Value = None) -> ExpectElement:
        """<expect>
          A number the run must give.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          quantity           text, required
                             a column of history.csv
          of                 value, minimum, maximum, limit, bifurcation or mark,
                             default value
                             its value at one time (of load steps and paths: at the
                             end), an extreme over the run, or its value at a limit
                             point, bifurcation or mark of a path
          number             whole number from 1 to 1000000, default 1
                             of the limit point, bifurcation or mark, in order
          at                 number >= 0 [s], optional
                             time of the value, one at which a row of results is written
          value              number [any unit], required
                             what it must be
          tolerance          number > 0 [any unit], required
                             by how much it may differ
          source             text, required
                             where the number comes from
          when               words, optional
                             parameter=value: checked only when the parameters have
                             these values, to 12 digits

        For example:
          <mbd name="tip_deflection">
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
        """
        ...
    def repeat(self, *, count: Value = None, index: Value = None) -> RepeatElement:
        """<repeat>
          Reads its contents several times.
          Stands in <mbd>, <repeat>, <curve>, <layup>, <section>, <airfoil>. Holds
          <material>, <layup>, <ply>, <section>, <station>, <sector>, <web>, <beam>,
          <arc>, <curve>, <point>, <body>, <drive>, <motion>, <load>, <distributed>,
          <rigid>, <point_mass>, <spring>, <bushing>, <joint_spring>, <joint_torque>,
          <drag>, <added_mass>, <extension>, <mark>, <stop>, <record>, <plot>, <expect>,
          <repeat>, <input>, <function>, <controller>, <reduction>, <fixed>,
          <rigid_link>, <revolute>, <prismatic>, <cylindrical>, <screw>, <universal>,
          <spherical>, <planar>, <point_on_line>, <distance>.

        Attributes:
          count              whole number from 0 to 1000000, required
                             how often its contents are read
          index              name, default i
                             parameter that counts from 0; {i+1} in names and places
                             becomes its value

        For example:
          <mbd name="balls" version="1">
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
        """
        ...
    def input(self, *, name: Value = None, unit: Value = None, value: Value = None) -> InputElement:
        """<input>
          A value that a program sets while the model runs; the laws of loads, joint
          torques, flows and drives use it by its name, as they use t. In a run of `mbd
          run` it keeps its `value`.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             what expressions of time call it: letters, digits and _,
                             after its <input>
          unit               text, optional
                             of its values, which expressions know in SI units; without
                             one they are taken as they are
          value              number, default 0
                             at the start, in that unit

        For example:
          <mbd name="servo_arm">
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
        """
        ...
    def function(self, content: Value = None, /, *, name: Value = None, value: Value = None, unit: Value = None, interpolation: Value = None) -> FunctionElement:
        """<function>
          A function of time that the laws of loads, drives and controllers call by its
          name, as ref(t) or ref(2*t+1): an expression, or as text a table of t [s] and
          its value in turn, t rising.
          Stands in <mbd>, <repeat>, <defaults>. Its text: pairs of numbers.

        Attributes:
          name               name, required
                             what expressions of time call it: letters, digits and _,
                             after its <function>
          value              expression of t [any unit], optional
                             an expression of t, of inputs and of functions before it,
                             or a table as text
          unit               text, optional
                             of the values of a table (default: SI units; those of t are
                             s)
          interpolation      linear or smooth, default linear
                             of a table: linear or a cubic spline, whose pieces meet
                             between the points; linear beyond the first and the last
                             point

        For example:
          <mbd name="two_carts">
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
        """
        ...
    def controller(self, *, name: Value = None, period: Value = None) -> ControllerElement:
        """<controller>
          Samples the motion at t = 0, period, 2 period, … and holds its outputs until
          the next instant: what it consists of is evaluated in its order, with states
          as they were; what it gives acts from that instant on, without delay. Steps
          end there.
          Stands in <mbd>, <repeat>, <defaults>. Holds <state>, <output>, <pid>,
          <state_space>.

        Attributes:
          name               name, required
                             name, for messages and results
          period             number > 0 [s], required
                             between its instants

        For example:
          <mbd name="two_carts">
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
        """
        ...
    def reduction(self, *, name: Value = None, of: Value = None, modes: Value = None, frame: Value = None) -> ReductionElement:
        """<reduction>
          Makes one element of component modes (Craig-Bampton) of beams and bodies, with
          what is fixed between them: static shapes of the places where something acts,
          and the slowest modes with these held. For parts that deform little, whatever
          their motion; what tension or compression change of their stiffness is only
          about right (the certificate says what that makes). Without it they are the
          beams they are.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among beams, bodies and rigid ones
          of                 words, required
                             names of beams and bodies; of a <rigid>, all of its parts
          modes              whole number from 0 to 1000, default 12
                             how many modes with its places held; 0: static shapes alone
          frame              place, optional
                             place of it whose frame floats with it (default: of the
                             places where something acts the first by name)

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...
    def fixed(self, *, name: Value = None, between: Value = None, at: Value = None) -> FixedElement:
        """<fixed>
          Nothing is left free.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)

        For example:
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
        """
        ...
    def rigid_link(self, *, name: Value = None, between: Value = None, at: Value = None) -> RigidLinkElement:
        """<rigid_link>
          A rigid, massless arm between two places at any distance.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)

        For example:
          <mbd name="swing">
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
        """
        ...
    def revolute(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> RevoluteElement:
        """<revolute>
          One rotation is left free, about the axis.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, required
                             direction of its axis; angles turn right-handed about it

        It has the coordinate angle, for records and drives.

        For example:
          <mbd name="swing">
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
        """
        ...
    def prismatic(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PrismaticElement:
        """<prismatic>
          One translation is left free, along the axis.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, required
                             direction of its axis; angles turn right-handed about it

        It has the coordinate displacement, for records and drives.

        For example:
          <mbd name="swing">
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
        """
        ...
    def cylindrical(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> CylindricalElement:
        """<cylindrical>
          One rotation and one translation are left free, about and along the axis.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, required
                             direction of its axis; angles turn right-handed about it

        It has the coordinates angle, displacement, for records and drives.

        For example:
          <mbd name="swing">
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
        """
        ...
    def screw(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, pitch: Value = None) -> ScrewElement:
        """<screw>
          Turning about the axis advances along it by the pitch a turn.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, required
                             direction of its axis; angles turn right-handed about it
          pitch              number [m], required
                             advance of b relative to a per turn about the axis;
                             negative for a left-handed screw

        It has the coordinates angle, displacement, for records and drives.

        For example:
          <mbd name="swing">
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
        """
        ...
    def universal(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, second_axis: Value = None) -> UniversalElement:
        """<universal>
          Two rotations are left free, about an axis fixed in a and one fixed in b.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, required
                             direction of its axis; angles turn right-handed about it
          second_axis        3 numbers, required
                             direction of its second axis, fixed in b, perpendicular to
                             the first, which is fixed in a

        For example:
          <mbd name="swing">
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
        """
        ...
    def spherical(self, *, name: Value = None, between: Value = None, at: Value = None) -> SphericalElement:
        """<spherical>
          Three rotations are left free.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)

        For example:
          <mbd name="swing">
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
        """
        ...
    def planar(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PlanarElement:
        """<planar>
          Two translations and one rotation are left free, in a plane.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, required
                             direction of its axis; angles turn right-handed about it

        It has the coordinate angle, for records and drives.

        For example:
          <mbd name="swing">
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
        """
        ...
    def point_on_line(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PointOnLineElement:
        """<point_on_line>
          A point of a stays on a line of b.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at                 3 numbers [m], optional
                             its point (default: that of b, or of a when b is the
                             ground)
          axis               3 numbers, required
                             direction of its axis; angles turn right-handed about it

        For example:
          <mbd name="swing">
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
        """
        ...
    def distance(self, *, name: Value = None, between: Value = None, at_a: Value = None, at_b: Value = None) -> DistanceElement:
        """<distance>
          A massless rod with ball joints at its ends.
          Stands in <mbd>, <repeat>, <defaults>.

        Attributes:
          name               name, required
                             name, unique among joints
          between            two places, required
                             the two places a and b it joins
          at_a               3 numbers [m], optional
                             its point of a (default: that of the place)
          at_b               3 numbers [m], optional
                             its point of b (default: that of the place)

        For example:
          <mbd name="swing">
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
        """
        ...

class State:
    """A copy of the state of a stepper, which Stepper.start() takes. Arrays have a row for each node, node 0 is the ground."""
    def __copy__(self) -> State:
        ...
    def copy(self) -> State:
        """Another copy."""
        ...
    @property
    def positions(self) -> numpy.ndarray:
        """Positions of the nodes, inertial axes [m], (nodes, 3): a view that can be written to."""
        ...
    @positions.setter
    def positions(self, value: Any) -> None: ...
    @property
    def quaternions(self) -> numpy.ndarray:
        """Orientations as unit quaternions x y z w, from node axes to inertial ones, (nodes, 4): a view that can be written to."""
        ...
    @quaternions.setter
    def quaternions(self, value: Any) -> None: ...
    @property
    def t(self) -> float:
        """Time [s]."""
        ...
    @t.setter
    def t(self, value: Any) -> None: ...
    @property
    def velocities(self) -> numpy.ndarray:
        """[v; w] of the nodes, node axes [m/s, rad/s], (nodes, 6): a view that can be written to."""
        ...
    @velocities.setter
    def velocities(self, value: Any) -> None: ...

class Stepper:
    """Carries a model through time. Made by Model.stepper(). Arrays have a row for each node, node 0 is the ground."""
    def __getitem__(self, name: str) -> numpy.ndarray:
        """What the model records, at the present state: a column (0-dimensional), a quantity or a record (1-dimensional), in the units of `columns`. Raises mbd.UnknownName."""
        ...
    @property
    def accelerations(self) -> numpy.ndarray:
        """Time derivatives of the velocities, node axes [m/s2, rad/s2], (nodes, 6): a view."""
        ...
    def angle(self, joint: str) -> float:
        """Of a joint that has one, counted on over whole turns [rad]."""
        ...
    def angular_velocity(self, place: str) -> numpy.ndarray:
        """Of a place, axes of the place [rad/s], (3,)."""
        ...
    @property
    def columns(self) -> List[Tuple[str, str]]:
        """Names and units of what is recorded."""
        ...
    @property
    def counters(self) -> Dict[str, Any]:
        """dict: steps, retries, iterations … since the start, as report.json has them."""
        ...
    @property
    def duration(self) -> float:
        """Of the transient [s]."""
        ...
    @property
    def energies(self) -> Dict[str, Any]:
        """dict: kinetic, strain, potential and total energy [J]."""
        ...
    def go_back(self, checkpoint: bytes) -> None:
        """To where remember() was called."""
        ...
    @property
    def input(self) -> Inputs:
        """Inputs by name: s.input["torque"] = 3 is set_input("torque", 3)."""
        ...
    @property
    def input_names(self) -> List[Tuple[str, str]]:
        """Names and units of the model's inputs."""
        ...
    @property
    def inputs(self) -> Dict[str, Any]:
        """dict: inputs of the model as they are now, in their units (`input_names`)."""
        ...
    @property
    def iterations(self) -> int:
        """Of Newton's method, in the last step."""
        ...
    @property
    def joints(self) -> List[str]:
        """Names of joints that have multipliers."""
        ...
    def linearise(self) -> Dict[str, Any]:
        """The same as linearize()."""
        ...
    def linearize(self) -> Dict[str, Any]:
        """As mbd.linearize(), about the present state."""
        ...
    @property
    def method(self) -> str:
        """generalized_alpha, radau or ida."""
        ...
    @property
    def multipliers(self) -> numpy.ndarray:
        """Of the constraints [N, N.m], in the order of the compiled model: a copy."""
        ...
    def node(self, place: str) -> int:
        """Row of a place ("arm.end", "arm@0.5", "body") in the arrays. Raises mbd.UnknownName."""
        ...
    @property
    def nodes(self) -> List[str]:
        """Names of the nodes, in the order of the arrays."""
        ...
    def orientation(self, place: str) -> numpy.ndarray:
        """Of a place: matrix from its axes to inertial ones, (3, 3)."""
        ...
    @property
    def places(self) -> List[str]:
        """Names that node(), position() … know."""
        ...
    def position(self, place: str) -> numpy.ndarray:
        """Of a place, inertial axes [m], (3,)."""
        ...
    @property
    def positions(self) -> numpy.ndarray:
        """Positions of the nodes, inertial axes [m], (nodes, 3): a view, which changes with each step."""
        ...
    @property
    def quaternions(self) -> numpy.ndarray:
        """Orientations as unit quaternions x y z w, from node axes to inertial ones, (nodes, 4): a view."""
        ...
    def reaction(self, joint: str) -> numpy.ndarray:
        """Force [N] and moment [N.m] on the joint's second part, joint axes, (6,)."""
        ...
    def record(self) -> Dict[str, Any]:
        """dict: all that the model records, at the present state, by column."""
        ...
    def remember(self) -> bytes:
        """As save(), for go_back(), which takes steps again with other inputs: the tangent is kept."""
        ...
    def restore(self, checkpoint: Any) -> None:
        """Goes on from what save() gave, bytes or a file, of the same model with the same method and settings. Raises mbd.UseError for others."""
        ...
    def save(self, file: Any = None) -> bytes:
        """The whole of the stepper as bytes, also written to `file` if there is one; to x.h5 with h5py, and the poses and velocities of the nodes beside it. It and who restores that go on alike to the last bit. Raises mbd.Error for ida, and mbd.UseError where the file cannot be written."""
        ...
    def set_input(self, name: str, value: float, over: Optional[float] = None, *, rate: float = 0.0, acceleration: float = 0.0) -> None:
        """Sets an input from now on, in its unit, until it is set again: to `value`, from where it goes on at `rate` and `acceleration` (in its unit by s and s2); or, with `over`, in a straight line from where it is, which is at `value` after `over` seconds and goes on. One that drives a joint has to go on from its value and rate, since a motion must not jump. Raises mbd.UnknownName and mbd.UseError."""
        ...
    def start(self, state: State) -> None:
        """Goes on from a State of the same Model. Accelerations and multipliers are found anew and the method forgets what was before, as after a jump: no continuation to the last bit. Raises mbd.UseError for states of other models, numbers that are not finite, and states that do not satisfy their constraints."""
        ...
    def state(self) -> State:
        """A copy of the present state."""
        ...
    def step(self, count: int = 1) -> None:
        """Takes `count` steps: whole fixed ones, or such as the tolerance asks for, of which the last ends at the duration. Raises mbd.RunError where one fails (the state is then the last that was reached) and, with a tolerance, after the end; Ctrl-C is looked for every 64 steps."""
        ...
    def step_to(self, t: float) -> None:
        """Steps until that time [s]: adaptive ones end there, fixed ones at the first of theirs that is not before it. Raises mbd.UseError for times before the present one and after the duration."""
        ...
    @property
    def t(self) -> float:
        """Time [s]."""
        ...
    @property
    def velocities(self) -> numpy.ndarray:
        """[v; w] of the nodes, node axes [m/s, rad/s], (nodes, 6): a view."""
        ...
    def velocity(self, place: str) -> numpy.ndarray:
        """Of a place, inertial axes [m/s], (3,)."""
        ...

class Error(Exception):
    """What mbd raises. str() is the message: what is wrong, where, and what to do about it."""
    ...

class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run or a study.

    results: mbd.Results up to there, or the study as far as it came; None if there is nothing yet
    """
    def __init__(self, results: Any = None) -> None:
        ...

class ModelError(Error):
    """A model, a setting of it or a directory that cannot be used, or a run that does not come to its first state.

    file: str, where the model says so, or None if the message names no place
    line: int, its line, or None
    """
    def __init__(self, message: Any, file: Any = None, line: Any = None) -> None:
        ...

class RunError(Error):
    """A run or a step in time that ended before its end, or a sweep whose tasks did.

    t: float, the time reached [s] (without a transient 0)
    results: mbd.Results up to there, of a sweep on Slurm the mbd.Sweep; None of a step
    """
    def __init__(self, message: Any, t: Any = 0.0, results: Any = None) -> None:
        ...

class UseError(Error, ValueError):
    """A call that makes no sense: a wrong shape, a number that is not finite, a state of another model."""
    ...

class UnknownName(Error, KeyError):
    """A node, joint, column or record that is not there; the message says which are."""
    ...

class ParameterElement(Element):
    ...

class IncludeElement(Element):
    ...

class DefaultsElement(Element):
    def material(self, *, name: Value = None, E: Value = None, nu: Value = None, EL: Value = None, ET: Value = None, EN: Value = None, GLT: Value = None, GLN: Value = None, GTN: Value = None, nuLT: Value = None, nuLN: Value = None, nuTN: Value = None, rho: Value = None, yield_: Value = None, Xt: Value = None, Xc: Value = None, Yt: Value = None, Yc: Value = None, SLT: Value = None, STN: Value = None, Zt: Value = None, Zc: Value = None, SLN: Value = None) -> MaterialElement:
        """A linear elastic material, of which sections are made: isotropic by E and nu; else along its axes, L along the fibres, N across the ply, T = N x L, by EL, ET, GLT, nuLT, nuTN, and what differs along N."""
        ...
    def layup(self, *, name: Value = None, listed: Value = None) -> LayupElement:
        """The plies of a wall, one after the other."""
        ...
    def ply(self, *, material: Value = None, thickness: Value = None, angle: Value = None) -> PlyElement:
        """<ply>
          A ply of a layup.
          Stands in <layup>, <repeat>, <defaults>.

        Attributes:
          material           text, required
                             name of its material
          thickness          number > 0 [m], required
                             its thickness
          angle              number [rad], default 0
                             theta, of its L from b1: L = cos(theta) b1 + sin(theta) (n
                             x b1), right-handed about the outward normal n of the wall

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def section(self, *, name: Value = None, interpolation: Value = None) -> SectionElement:
        """Stiffness and mass of a cross-section, axes b1 (along the beam) b2 b3."""
        ...
    def station(self, *, at: Value = None) -> StationElement:
        """<station>
          The section at one place of the beam; two or more, from 0 to 1, in order.
          Stands in <section>, <repeat>, <defaults>. Holds <stiffness>, <mass>, <tube>,
          <bar>, <rectangle>, <box>, <I>, <C>, <mesh>, <airfoil>.

        Attributes:
          at                 number from 0 to 1, required
                             fraction of the reference length of the beam

        For example:
          <mbd name="mast">
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
        """
        ...
    def stiffness(self, content: Value = None, /, *, EA: Value = None, GA2: Value = None, GA3: Value = None, GJ: Value = None, EI2: Value = None, EI3: Value = None, D12: Value = None, D13: Value = None, D14: Value = None, D15: Value = None, D16: Value = None, D23: Value = None, D24: Value = None, D25: Value = None, D26: Value = None, D34: Value = None, D35: Value = None, D36: Value = None, D45: Value = None, D46: Value = None, D56: Value = None) -> StiffnessElement:
        """<stiffness>
          D, from strains [stretch, shears; twist, curvatures] to [N1 Q2 Q3; M1 M2 M3]:
          its entries by name, the first six at least, or all of them row by row.
          Stands in <section>, <station>, <defaults>. Its text: 36 numbers.

        Attributes:
          EA                 number > 0, or inf [N], optional
                             D11, axial; as all of the diagonal it may be inf: no
                             compliance, the strain is zero
          GA2                number > 0, or inf [N], optional
                             D22, shear along b2
          GA3                number > 0, or inf [N], optional
                             D33, shear along b3
          GJ                 number > 0, or inf [N.m2], optional
                             D44, torsion
          EI2                number > 0, or inf [N.m2], optional
                             D55, bending about b2
          EI3                number > 0, or inf [N.m2], optional
                             D66, bending about b3
          D12                number [N], default 0
                             coupling of extension and shear along b2; D21 is the same,
                             and so below
          D13                number [N], default 0
                             coupling of extension and shear along b3
          D14                number [N.m], default 0
                             coupling of extension and twist
          D15                number [N.m], default 0
                             coupling of extension and bending about b2
          D16                number [N.m], default 0
                             coupling of extension and bending about b3
          D23                number [N], default 0
                             coupling of shear along b2 and shear along b3
          D24                number [N.m], default 0
                             coupling of shear along b2 and twist
          D25                number [N.m], default 0
                             coupling of shear along b2 and bending about b2
          D26                number [N.m], default 0
                             coupling of shear along b2 and bending about b3
          D34                number [N.m], default 0
                             coupling of shear along b3 and twist
          D35                number [N.m], default 0
                             coupling of shear along b3 and bending about b2
          D36                number [N.m], default 0
                             coupling of shear along b3 and bending about b3
          D45                number [N.m2], default 0
                             coupling of twist and bending about b2
          D46                number [N.m2], default 0
                             coupling of twist and bending about b3
          D56                number [N.m2], default 0
                             coupling of bending about b2 and bending about b3

        For example:
          <mbd name="mast">
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
        """
        ...
    def mass(self, *, per_length: Value = None, inertia: Value = None, center: Value = None) -> MassElement:
        """<mass>
          M per length about the reference line: [m I, -m c~; m c~, J], c = (0, x2, x3).
          Stands in <section>, <station>, <defaults>.

        Attributes:
          per_length         number > 0 [kg/m], required
                             mass per unit length
          inertia            3 or 6 numbers [kg.m], required
                             per length about the reference line: J11 J22 J33 [J12 J13
                             J23]
          center             2 numbers [m], default 0 0
                             mass centre in the section: x2 x3

        For example:
          <mbd name="mast">
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
        """
        ...
    def damping(self, *, stiffness_proportional: Value = None, mass_proportional: Value = None, EA: Value = None, GA2: Value = None, GA3: Value = None, GJ: Value = None, EI2: Value = None, EI3: Value = None, D12: Value = None, D13: Value = None, D14: Value = None, D15: Value = None, D16: Value = None, D23: Value = None, D24: Value = None, D25: Value = None, D26: Value = None, D34: Value = None, D35: Value = None, D36: Value = None, D45: Value = None, D46: Value = None, D56: Value = None) -> DampingElement:
        """<damping>
          Resistance to rates of strain and to velocities, at least one kind, in a
          <transient>; without it a beam is elastic.
          Stands in <section>, <defaults>.

        Attributes:
          stiffness_proportional number >= 0 [s], default 0
                             beta: viscous forces are beta D times rates of strain;
                             damping ratio beta omega/2
          mass_proportional  number >= 0 [1/s], default 0
                             alpha: -alpha times the momentum of all masses of the beam,
                             rigid motion too; damping ratio alpha/(2 omega)
          EA                 number >= 0 [N.s], default 0
                             D11, axial: viscous, besides beta D; and so below
          GA2                number >= 0 [N.s], default 0
                             D22, shear along b2
          GA3                number >= 0 [N.s], default 0
                             D33, shear along b3
          GJ                 number >= 0 [N.m2.s], default 0
                             D44, torsion
          EI2                number >= 0 [N.m2.s], default 0
                             D55, bending about b2
          EI3                number >= 0 [N.m2.s], default 0
                             D66, bending about b3
          D12                number [N.s], default 0
                             coupling of extension and shear along b2
          D13                number [N.s], default 0
                             coupling of extension and shear along b3
          D14                number [N.m.s], default 0
                             coupling of extension and twist
          D15                number [N.m.s], default 0
                             coupling of extension and bending about b2
          D16                number [N.m.s], default 0
                             coupling of extension and bending about b3
          D23                number [N.s], default 0
                             coupling of shear along b2 and shear along b3
          D24                number [N.m.s], default 0
                             coupling of shear along b2 and twist
          D25                number [N.m.s], default 0
                             coupling of shear along b2 and bending about b2
          D26                number [N.m.s], default 0
                             coupling of shear along b2 and bending about b3
          D34                number [N.m.s], default 0
                             coupling of shear along b3 and twist
          D35                number [N.m.s], default 0
                             coupling of shear along b3 and bending about b2
          D36                number [N.m.s], default 0
                             coupling of shear along b3 and bending about b3
          D45                number [N.m2.s], default 0
                             coupling of twist and bending about b2
          D46                number [N.m2.s], default 0
                             coupling of twist and bending about b3
          D56                number [N.m2.s], default 0
                             coupling of bending about b2 and bending about b3

        For example:
          <mbd name="mast">
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
        """
        ...
    def tube(self, *, radius: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> TubeElement:
        """<tube>
          A tube: its plies lie round it, their normals point outward.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          radius             number > 0 [m], required
                             outer radius
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             of its wall, where that is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def bar(self, *, radius: Value = None, material: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> BarElement:
        """<bar>
          A solid round bar of one material, whose N is b3.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          radius             number > 0 [m], required
                             outer radius
          material           text, required
                             name of its material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def rectangle(self, *, width: Value = None, height: Value = None, layup: Value = None, material: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> RectangleElement:
        """<rectangle>
          A solid rectangle of plies across b3, listed from below; their normal is b3.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], optional
                             along b3, of one material; with a layup it is the thickness
                             of that
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def box(self, *, width: Value = None, height: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, corners: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> BoxElement:
        """<box>
          A box with walls all round; the normals of its plies point outward.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             of its wall, where that is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          corners            mitred or butt, default mitred
                             mitred: plies turn round them; butt: walls of a box across
                             b3 go through, those across b2 stand between them; of an
                             airfoil, the wall of the sector that is listed first goes
                             through, in one sector the wall before the corner (corners
                             that point inward are mitred)
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def I(self, *, width: Value = None, height: Value = None, flange: Value = None, web: Value = None, material: Value = None, flange_thickness: Value = None, web_thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> IElement:
        """<I>
          An I: flanges across b3 at top and bottom go through, normals away from the
          middle; the web stands between them, its normal b2.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          flange             text, optional
                             name of the layup of its flanges
          web                text, optional
                             name of the layup of its web
          material           text, optional
                             name of its material, in place of plies
          flange_thickness   number > 0 [m], optional
                             of its flanges, where it is of one material
          web_thickness      number > 0 [m], optional
                             of its web, where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def C(self, *, width: Value = None, height: Value = None, flange: Value = None, web: Value = None, material: Value = None, flange_thickness: Value = None, web_thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> CElement:
        """<C>
          A C: as an I, with the web at the side of -b2, its outer face at x2 = 0, its
          normal -b2.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          flange             text, optional
                             name of the layup of its flanges
          web                text, optional
                             name of the layup of its web
          material           text, optional
                             name of its material, in place of plies
          flange_thickness   number > 0 [m], optional
                             of its flanges, where it is of one material
          web_thickness      number > 0 [m], optional
                             of its web, where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def mesh(self, *, file: Value = None, unit: Value = None, material: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> MeshElement:
        """<mesh>
          A mesh of triangles and quadrilaterals in a file of Gmsh (.msh of format 2.2
          or 4.1): x and y of the file are x2 and x3. Orders of the elements are raised
          until the tolerance is met; the mesh itself stays.
          Stands in <section>, <station>, <defaults>. Holds <region>.

        Attributes:
          file               text, required
                             the .msh file; a relative path is from the model's
                             directory
          unit               number > 0 [m], default 1
                             length of one unit of the file, such as 1 mm
          material           text, optional
                             of elements of no <region>, their angle 0 and their N b3
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 0.001
                             the order of the elements is raised until every entry ij of
                             D changes less, over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def region(self, *, name: Value = None, material: Value = None, angle: Value = None, normal: Value = None) -> RegionElement:
        """<region>
          What the elements of a physical surface of a mesh consist of.
          Stands in <mesh>, <defaults>.

        Attributes:
          name               text, required
                             of the physical surface in the file, or its number where it
                             has no name
          material           text, required
                             name of its material
          angle              number [rad], default 0
                             theta, of its L from b1, as of a ply
          normal             number [rad], default 1.5707963267948966
                             direction of its N: angle from b2 towards b3, before the
                             section is turned

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def airfoil(self, *, unit: Value = None, corner_angle: Value = None, corners: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> AirfoilElement:
        """<airfoil>
          An aerofoil, or any section of walls along a closed curve, with webs between
          them. <points> are those of its outer surface, x2 and x3 in turn, all round
          from any of them, either way; between corners they are joined by smooth curves
          (cubic splines). Plies lie inside, at constant distances from the curve.
          Stands in <section>, <station>, <defaults>. Holds <points>, <sector>, <web>,
          <repeat>.

        Attributes:
          unit               number > 0 [m], default 1
                             length of one unit of its points: such as 1 mm, or the
                             chord
          corner_angle       number from 0 to 3.141592653589793 [rad], default
                             1.0471975511965976
                             where the line from point to point turns by more there are
                             corners; 0: straight lines between all points
          corners            mitred or butt, default mitred
                             mitred: plies turn round them; butt: walls of a box across
                             b3 go through, those across b2 stand between them; of an
                             airfoil, the wall of the sector that is listed first goes
                             through, in one sector the wall before the corner (corners
                             that point inward are mitred)
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-04
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def sector(self, *, from_: Value = None, to: Value = None, from_point: Value = None, to_point: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, bare: Value = None) -> SectorElement:
        """<sector>
          A part of the contour of an airfoil, in the order of its points: its plies lie
          inside the contour, their normals point outward. Sectors cover the contour,
          none twice.
          Stands in <airfoil>, <repeat>, <defaults>.

        Attributes:
          from               number from 0 to 1, optional
                             where it begins: fraction of the length of the contour,
                             from its first point on (default: 0)
          to                 number from 0 to 1, optional
                             where it ends (default: 1); if that is not beyond from, it
                             goes through the first point
          from_point         whole number from 1 to 1000000, optional
                             in place of from: the number of a point, 1 for the first
          to_point           whole number from 1 to 1000000, optional
                             in place of to: the number of a point
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          bare               off or on, default off
                             on: there is no wall, the section is open

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def web(self, *, from_: Value = None, to: Value = None, from_point: Value = None, to_point: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None) -> WebElement:
        """<web>
          A straight wall between two places of the contour of an airfoil. Its plies lie
          about the line between these, their normal to the right of who goes from the
          first to the second (b2 to the right, b3 up); it stands on the inner surfaces
          of the walls. On a border of two sectors it stands on the thicker one (of
          alike ones on that which is listed first), which then reaches to the far edge
          of its foot.
          Stands in <airfoil>, <repeat>, <defaults>.

        Attributes:
          from               number from 0 to 1, optional
                             its first end: fraction of the length of the contour, from
                             its first point on
          to                 number from 0 to 1, optional
                             its second end
          from_point         whole number from 1 to 1000000, optional
                             in place of from: the number of a point, 1 for the first
          to_point           whole number from 1 to 1000000, optional
                             in place of to: the number of a point
          layup              text, optional
                             name of its layup; from the inside, the first ply is the
                             one its normal points away from
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def beam(self, *, name: Value = None, section: Value = None, from_: Value = None, to: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> BeamElement:
        """A straight beam."""
        ...
    def arc(self, *, name: Value = None, section: Value = None, from_: Value = None, center: Value = None, axis: Value = None, angle: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> ArcElement:
        """A beam along a circular arc: `from`, turned about the centre."""
        ...
    def curve(self, *, name: Value = None, section: Value = None, degree: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> CurveElement:
        """A beam along a smooth curve through points."""
        ...
    def point(self, *, at: Value = None, normal: Value = None, twist: Value = None) -> PointElement:
        """<point>
          A point of a curve.
          Stands in <curve>, <repeat>, <defaults>.

        Attributes:
          at                 3 numbers [m], required
                             position
          normal             3 numbers, optional
                             b3 there (default: the normal of the curve)
          twist              number [rad], default 0
                             turns the section, right-handed about the tangent

        For example:
          <mbd name="hook">
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
        """
        ...
    def body(self, *, name: Value = None, attached_to: Value = None, at: Value = None, orientation: Value = None, mass: Value = None, center: Value = None, inertia: Value = None, velocity: Value = None, angular_velocity: Value = None) -> BodyElement:
        """A rigid body, free or fixed to a place."""
        ...
    def shape(self, *, box: Value = None, cylinder: Value = None, sphere: Value = None, mesh: Value = None, unit: Value = None, at: Value = None, orientation: Value = None, density: Value = None, rectangle: Value = None, ellipse: Value = None, to: Value = None, colour: Value = None) -> ShapeElement:
        """<shape>
          What a body or a beam looks like, for the eye: pages, pictures and files for
          ParaView. Of a body with a density it is also its mass.
          Stands in <body>, <beam>, <arc>, <curve>, <defaults>.

        Attributes:
          box                3 numbers, each > 0 [m], optional
                             of a body: its sides along the axes of the shape
          cylinder           2 numbers, each > 0 [m], optional
                             of a body: diameter and length, which lies along the third
                             axis
          sphere             number > 0 [m], optional
                             of a body: diameter
          mesh               text, optional
                             of a body: a file of triangles, .stl, .obj, .gltf or .glb;
                             a relative path is from the model's directory. The file's
                             origin and axes are those of the shape
          unit               number > 0 [m], optional
                             length of one unit of the mesh's file, such as 1 mm
                             (default 1 m)
          at                 3 numbers [m], optional
                             middle of the form (of a mesh: its origin) from the
                             reference point, body axes (default 0 0 0)
          orientation        3 or 9 numbers [rad], optional
                             axes of the shape in the body's: rotation vector, or
                             (without unit) matrix row by row
          density            number > 0 [kg/m3], optional
                             of a body: the form is solid and adds its mass and inertia
                             to those stated
          rectangle          2 numbers, each > 0 [m], optional
                             of a beam: sides along b2 and b3, in place of those that
                             its stiffness suggests
          ellipse            2 numbers, each > 0 [m], optional
                             of a beam: diameters along b2 and b3
          to                 2 numbers, each > 0 [m], optional
                             of a beam: sides or diameters at its end (default: as at
                             the start)
          colour             text, optional
                             #rrggbb, or one of the 17 names of CSS: black silver gray
                             white maroon red purple fuchsia green lime olive yellow
                             navy blue teal aqua orange. A shape that states nothing
                             else colours what is drawn without it

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...
    def drive(self, *, joint: Value = None, rate: Value = None, angle: Value = None, speed: Value = None, displacement: Value = None) -> DriveElement:
        """Prescribes the angle or the displacement of a joint."""
        ...
    def motion(self, *, name: Value = None, of: Value = None, displacement: Value = None, velocity: Value = None, rotation: Value = None, axis: Value = None, angle: Value = None, rate: Value = None) -> MotionElement:
        """Prescribes the motion of a place; what is not given is free."""
        ...
    def load(self, *, name: Value = None, at: Value = None, force: Value = None, moment: Value = None, follower_force: Value = None, follower_moment: Value = None, offset: Value = None) -> LoadElement:
        """A force and moment at a place."""
        ...
    def distributed(self, *, name: Value = None, beam: Value = None, from_: Value = None, to: Value = None, force: Value = None, moment: Value = None, follower_force: Value = None, follower_moment: Value = None) -> DistributedElement:
        """Forces and moments per unit of reference length along a beam; expressions of s, the fraction of that length, and t."""
        ...
    def rigid(self, *, name: Value = None, of: Value = None) -> RigidElement:
        """Makes one rigid body of beams and free bodies: one node with the mass of them all. Places of its beams stay places; joints between two of them do nothing."""
        ...
    def point_mass(self, *, name: Value = None, at: Value = None, mass: Value = None, offset: Value = None) -> PointMassElement:
        """A mass without inertia of its own that moves with a place."""
        ...
    def spring(self, *, name: Value = None, between: Value = None, at_a: Value = None, at_b: Value = None, stiffness: Value = None, damping: Value = None, length: Value = None, force: Value = None, damping_force: Value = None) -> SpringElement:
        """A spring, a damper or both along the line between two points of two places."""
        ...
    def bushing(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, second_axis: Value = None, stiffness: Value = None, angular_stiffness: Value = None, damping: Value = None, angular_damping: Value = None) -> BushingElement:
        """An elastic connection of two frames, which coincide in the reference configuration, in all six directions."""
        ...
    def joint_spring(self, *, name: Value = None, joint: Value = None, angular_stiffness: Value = None, angular_damping: Value = None, rest_angle: Value = None, moment: Value = None, damping_moment: Value = None, stiffness: Value = None, damping: Value = None, rest_displacement: Value = None, force: Value = None, damping_force: Value = None) -> JointSpringElement:
        """A spring, a damper or both on the free coordinate of a joint: its angle, over any number of turns, or its displacement."""
        ...
    def joint_torque(self, *, name: Value = None, joint: Value = None, moment: Value = None, force: Value = None) -> JointTorqueElement:
        """A moment about or a force along the axis of a joint, of time; the joint turns freely."""
        ...
    def drag(self, *, name: Value = None, density: Value = None, flow: Value = None, beam: Value = None, from_: Value = None, to: Value = None, diameter: Value = None, normal_coefficient: Value = None, tangential_coefficient: Value = None, at: Value = None, area: Value = None, coefficient: Value = None, offset: Value = None) -> DragElement:
        """Quadratic drag of a fluid, still or flowing, along a beam or at a place."""
        ...
    def added_mass(self, *, name: Value = None, beam: Value = None, from_: Value = None, to: Value = None, density: Value = None, diameter: Value = None, coefficient: Value = None, at: Value = None, matrix: Value = None) -> AddedMassElement:
        """Inertia of a fluid that a beam or a body sets in motion: of a fluid at rest, without its weight."""
        ...
    def extension(self, *, name: Value = None, force: Value = None, at: Value = None, values: Value = None) -> ExtensionElement:
        """A force that a plug-in computes, as `mbd run --plugin FILE` gives it (libmbd/plugin.h)."""
        ...
    def base_motion(self, *, acceleration: Value = None, velocity: Value = None, displacement: Value = None) -> BaseMotionElement:
        """Accelerates the ground without turning it; everything else is relative to the ground."""
        ...
    def gravity(self, *, acceleration: Value = None) -> GravityElement:
        """Uniform gravity on everything that has mass."""
        ...
    def static(self, *, steps: Value = None, tolerance: Value = None, solver: Value = None, line_search: Value = None, linear_solver: Value = None) -> StaticElement:
        """Static equilibrium at t = 0, before the transient if there is one."""
        ...
    def path(self, *, method: Value = None, direction: Value = None, step: Value = None, max_step: Value = None, points: Value = None, length: Value = None, branch: Value = None, tolerance: Value = None) -> PathElement:
        """Follows the equilibria over the load factor, from 0, through limit points and bifurcations; instead of <static> and <transient>."""
        ...
    def mark(self, *, quantity: Value = None, value: Value = None) -> MarkElement:
        """<mark>
          A point of the path to be located, shown and drawn: where a column passes a
          value.
          Stands in <path>, <repeat>, <defaults>.

        Attributes:
          quantity           text, required
                             a column of path.csv
          value              number [any unit], required
                             the value it passes, from either side

        For example:
          <mbd name="snap_through">
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
        """
        ...
    def stop(self, *, quantity: Value = None, value: Value = None) -> StopElement:
        """<stop>
          A mark at which the path ends.
          Stands in <path>, <repeat>, <defaults>.

        Attributes:
          quantity           text, required
                             a column of path.csv
          value              number [any unit], required
                             the value it passes, from either side

        For example:
          <mbd name="snap_through">
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
        """
        ...
    def transient(self, *, duration: Value = None, method: Value = None, step: Value = None, tolerance: Value = None, position_tolerance: Value = None, rotation_tolerance: Value = None, velocity_tolerance: Value = None, angular_velocity_tolerance: Value = None, errors: Value = None, stages: Value = None, max_step: Value = None, output: Value = None, rho_infinity: Value = None, balance: Value = None, newton_tolerance: Value = None, inertia: Value = None, linear_solver: Value = None) -> TransientElement:
        """Integration in time, in fixed steps or in steps that follow an estimated error."""
        ...
    def modes(self, *, count: Value = None, near: Value = None, rate: Value = None, at: Value = None, axis: Value = None, through: Value = None, at_rest: Value = None, mac: Value = None) -> ModesElement:
        """Modes of small motions: frequencies, damping and shapes, in modes.csv and modes.json beside the results of a run. `mbd modes` has options of the same names, which hold before these attributes."""
        ...
    def record(self, *, name: Value = None, at: Value = None, joint: Value = None, spring: Value = None, section_point: Value = None, quantities: Value = None) -> RecordElement:
        """Columns of history.csv."""
        ...
    def motion_output(self, *, frames: Value = None) -> MotionOutputElement:
        """Keeps the motion of every node, resultants along beams and reactions of joints in motion.bin, for `mbd view`. Without it nothing is kept, and `mbd run --motion` does the same for any model."""
        ...
    def plot(self, *, x: Value = None, y: Value = None, x_scale: Value = None, y_scale: Value = None, x_label: Value = None, y_label: Value = None, title: Value = None, x_range: Value = None) -> PlotElement:
        """A panel of history.svg."""
        ...
    def expect(self, *, quantity: Value = None, of: Value = None, number: Value = None, at: Value = None, value: Value = None, tolerance: Value = None, source: Value = None, when: Value = None) -> ExpectElement:
        """A number the run must give."""
        ...
    def input(self, *, name: Value = None, unit: Value = None, value: Value = None) -> InputElement:
        """A value that a program sets while the model runs; the laws of loads, joint torques, flows and drives use it by its name, as they use t. In a run of `mbd run` it keeps its `value`."""
        ...
    def function(self, content: Value = None, /, *, name: Value = None, value: Value = None, unit: Value = None, interpolation: Value = None) -> FunctionElement:
        """A function of time that the laws of loads, drives and controllers call by its name, as ref(t) or ref(2*t+1): an expression, or as text a table of t [s] and its value in turn, t rising."""
        ...
    def controller(self, *, name: Value = None, period: Value = None) -> ControllerElement:
        """Samples the motion at t = 0, period, 2 period, … and holds its outputs until the next instant: what it consists of is evaluated in its order, with states as they were; what it gives acts from that instant on, without delay. Steps end there."""
        ...
    def reduction(self, *, name: Value = None, of: Value = None, modes: Value = None, frame: Value = None) -> ReductionElement:
        """Makes one element of component modes (Craig-Bampton) of beams and bodies, with what is fixed between them: static shapes of the places where something acts, and the slowest modes with these held. For parts that deform little, whatever their motion; what tension or compression change of their stiffness is only about right (the certificate says what that makes). Without it they are the beams they are."""
        ...
    def fixed(self, *, name: Value = None, between: Value = None, at: Value = None) -> FixedElement:
        """Nothing is left free."""
        ...
    def rigid_link(self, *, name: Value = None, between: Value = None, at: Value = None) -> RigidLinkElement:
        """A rigid, massless arm between two places at any distance."""
        ...
    def revolute(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> RevoluteElement:
        """One rotation is left free, about the axis."""
        ...
    def prismatic(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PrismaticElement:
        """One translation is left free, along the axis."""
        ...
    def cylindrical(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> CylindricalElement:
        """One rotation and one translation are left free, about and along the axis."""
        ...
    def screw(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, pitch: Value = None) -> ScrewElement:
        """Turning about the axis advances along it by the pitch a turn."""
        ...
    def universal(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, second_axis: Value = None) -> UniversalElement:
        """Two rotations are left free, about an axis fixed in a and one fixed in b."""
        ...
    def spherical(self, *, name: Value = None, between: Value = None, at: Value = None) -> SphericalElement:
        """Three rotations are left free."""
        ...
    def planar(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PlanarElement:
        """Two translations and one rotation are left free, in a plane."""
        ...
    def point_on_line(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PointOnLineElement:
        """A point of a stays on a line of b."""
        ...
    def distance(self, *, name: Value = None, between: Value = None, at_a: Value = None, at_b: Value = None) -> DistanceElement:
        """A massless rod with ball joints at its ends."""
        ...

class MaterialElement(Element):
    ...

class LayupElement(Element):
    def ply(self, *, material: Value = None, thickness: Value = None, angle: Value = None) -> PlyElement:
        """<ply>
          A ply of a layup.
          Stands in <layup>, <repeat>, <defaults>.

        Attributes:
          material           text, required
                             name of its material
          thickness          number > 0 [m], required
                             its thickness
          angle              number [rad], default 0
                             theta, of its L from b1: L = cos(theta) b1 + sin(theta) (n
                             x b1), right-handed about the outward normal n of the wall

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def repeat(self, *, count: Value = None, index: Value = None) -> RepeatElement:
        """Reads its contents several times."""
        ...

class PlyElement(Element):
    ...

class SectionElement(Element):
    def station(self, *, at: Value = None) -> StationElement:
        """<station>
          The section at one place of the beam; two or more, from 0 to 1, in order.
          Stands in <section>, <repeat>, <defaults>. Holds <stiffness>, <mass>, <tube>,
          <bar>, <rectangle>, <box>, <I>, <C>, <mesh>, <airfoil>.

        Attributes:
          at                 number from 0 to 1, required
                             fraction of the reference length of the beam

        For example:
          <mbd name="mast">
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
        """
        ...
    def stiffness(self, content: Value = None, /, *, EA: Value = None, GA2: Value = None, GA3: Value = None, GJ: Value = None, EI2: Value = None, EI3: Value = None, D12: Value = None, D13: Value = None, D14: Value = None, D15: Value = None, D16: Value = None, D23: Value = None, D24: Value = None, D25: Value = None, D26: Value = None, D34: Value = None, D35: Value = None, D36: Value = None, D45: Value = None, D46: Value = None, D56: Value = None) -> StiffnessElement:
        """<stiffness>
          D, from strains [stretch, shears; twist, curvatures] to [N1 Q2 Q3; M1 M2 M3]:
          its entries by name, the first six at least, or all of them row by row.
          Stands in <section>, <station>, <defaults>. Its text: 36 numbers.

        Attributes:
          EA                 number > 0, or inf [N], optional
                             D11, axial; as all of the diagonal it may be inf: no
                             compliance, the strain is zero
          GA2                number > 0, or inf [N], optional
                             D22, shear along b2
          GA3                number > 0, or inf [N], optional
                             D33, shear along b3
          GJ                 number > 0, or inf [N.m2], optional
                             D44, torsion
          EI2                number > 0, or inf [N.m2], optional
                             D55, bending about b2
          EI3                number > 0, or inf [N.m2], optional
                             D66, bending about b3
          D12                number [N], default 0
                             coupling of extension and shear along b2; D21 is the same,
                             and so below
          D13                number [N], default 0
                             coupling of extension and shear along b3
          D14                number [N.m], default 0
                             coupling of extension and twist
          D15                number [N.m], default 0
                             coupling of extension and bending about b2
          D16                number [N.m], default 0
                             coupling of extension and bending about b3
          D23                number [N], default 0
                             coupling of shear along b2 and shear along b3
          D24                number [N.m], default 0
                             coupling of shear along b2 and twist
          D25                number [N.m], default 0
                             coupling of shear along b2 and bending about b2
          D26                number [N.m], default 0
                             coupling of shear along b2 and bending about b3
          D34                number [N.m], default 0
                             coupling of shear along b3 and twist
          D35                number [N.m], default 0
                             coupling of shear along b3 and bending about b2
          D36                number [N.m], default 0
                             coupling of shear along b3 and bending about b3
          D45                number [N.m2], default 0
                             coupling of twist and bending about b2
          D46                number [N.m2], default 0
                             coupling of twist and bending about b3
          D56                number [N.m2], default 0
                             coupling of bending about b2 and bending about b3

        For example:
          <mbd name="mast">
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
        """
        ...
    def mass(self, *, per_length: Value = None, inertia: Value = None, center: Value = None) -> MassElement:
        """<mass>
          M per length about the reference line: [m I, -m c~; m c~, J], c = (0, x2, x3).
          Stands in <section>, <station>, <defaults>.

        Attributes:
          per_length         number > 0 [kg/m], required
                             mass per unit length
          inertia            3 or 6 numbers [kg.m], required
                             per length about the reference line: J11 J22 J33 [J12 J13
                             J23]
          center             2 numbers [m], default 0 0
                             mass centre in the section: x2 x3

        For example:
          <mbd name="mast">
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
        """
        ...
    def damping(self, *, stiffness_proportional: Value = None, mass_proportional: Value = None, EA: Value = None, GA2: Value = None, GA3: Value = None, GJ: Value = None, EI2: Value = None, EI3: Value = None, D12: Value = None, D13: Value = None, D14: Value = None, D15: Value = None, D16: Value = None, D23: Value = None, D24: Value = None, D25: Value = None, D26: Value = None, D34: Value = None, D35: Value = None, D36: Value = None, D45: Value = None, D46: Value = None, D56: Value = None) -> DampingElement:
        """<damping>
          Resistance to rates of strain and to velocities, at least one kind, in a
          <transient>; without it a beam is elastic.
          Stands in <section>, <defaults>.

        Attributes:
          stiffness_proportional number >= 0 [s], default 0
                             beta: viscous forces are beta D times rates of strain;
                             damping ratio beta omega/2
          mass_proportional  number >= 0 [1/s], default 0
                             alpha: -alpha times the momentum of all masses of the beam,
                             rigid motion too; damping ratio alpha/(2 omega)
          EA                 number >= 0 [N.s], default 0
                             D11, axial: viscous, besides beta D; and so below
          GA2                number >= 0 [N.s], default 0
                             D22, shear along b2
          GA3                number >= 0 [N.s], default 0
                             D33, shear along b3
          GJ                 number >= 0 [N.m2.s], default 0
                             D44, torsion
          EI2                number >= 0 [N.m2.s], default 0
                             D55, bending about b2
          EI3                number >= 0 [N.m2.s], default 0
                             D66, bending about b3
          D12                number [N.s], default 0
                             coupling of extension and shear along b2
          D13                number [N.s], default 0
                             coupling of extension and shear along b3
          D14                number [N.m.s], default 0
                             coupling of extension and twist
          D15                number [N.m.s], default 0
                             coupling of extension and bending about b2
          D16                number [N.m.s], default 0
                             coupling of extension and bending about b3
          D23                number [N.s], default 0
                             coupling of shear along b2 and shear along b3
          D24                number [N.m.s], default 0
                             coupling of shear along b2 and twist
          D25                number [N.m.s], default 0
                             coupling of shear along b2 and bending about b2
          D26                number [N.m.s], default 0
                             coupling of shear along b2 and bending about b3
          D34                number [N.m.s], default 0
                             coupling of shear along b3 and twist
          D35                number [N.m.s], default 0
                             coupling of shear along b3 and bending about b2
          D36                number [N.m.s], default 0
                             coupling of shear along b3 and bending about b3
          D45                number [N.m2.s], default 0
                             coupling of twist and bending about b2
          D46                number [N.m2.s], default 0
                             coupling of twist and bending about b3
          D56                number [N.m2.s], default 0
                             coupling of bending about b2 and bending about b3

        For example:
          <mbd name="mast">
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
        """
        ...
    def tube(self, *, radius: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> TubeElement:
        """<tube>
          A tube: its plies lie round it, their normals point outward.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          radius             number > 0 [m], required
                             outer radius
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             of its wall, where that is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def bar(self, *, radius: Value = None, material: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> BarElement:
        """<bar>
          A solid round bar of one material, whose N is b3.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          radius             number > 0 [m], required
                             outer radius
          material           text, required
                             name of its material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def rectangle(self, *, width: Value = None, height: Value = None, layup: Value = None, material: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> RectangleElement:
        """<rectangle>
          A solid rectangle of plies across b3, listed from below; their normal is b3.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], optional
                             along b3, of one material; with a layup it is the thickness
                             of that
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def box(self, *, width: Value = None, height: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, corners: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> BoxElement:
        """<box>
          A box with walls all round; the normals of its plies point outward.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             of its wall, where that is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          corners            mitred or butt, default mitred
                             mitred: plies turn round them; butt: walls of a box across
                             b3 go through, those across b2 stand between them; of an
                             airfoil, the wall of the sector that is listed first goes
                             through, in one sector the wall before the corner (corners
                             that point inward are mitred)
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def I(self, *, width: Value = None, height: Value = None, flange: Value = None, web: Value = None, material: Value = None, flange_thickness: Value = None, web_thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> IElement:
        """<I>
          An I: flanges across b3 at top and bottom go through, normals away from the
          middle; the web stands between them, its normal b2.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          flange             text, optional
                             name of the layup of its flanges
          web                text, optional
                             name of the layup of its web
          material           text, optional
                             name of its material, in place of plies
          flange_thickness   number > 0 [m], optional
                             of its flanges, where it is of one material
          web_thickness      number > 0 [m], optional
                             of its web, where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def C(self, *, width: Value = None, height: Value = None, flange: Value = None, web: Value = None, material: Value = None, flange_thickness: Value = None, web_thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> CElement:
        """<C>
          A C: as an I, with the web at the side of -b2, its outer face at x2 = 0, its
          normal -b2.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          flange             text, optional
                             name of the layup of its flanges
          web                text, optional
                             name of the layup of its web
          material           text, optional
                             name of its material, in place of plies
          flange_thickness   number > 0 [m], optional
                             of its flanges, where it is of one material
          web_thickness      number > 0 [m], optional
                             of its web, where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def mesh(self, *, file: Value = None, unit: Value = None, material: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> MeshElement:
        """<mesh>
          A mesh of triangles and quadrilaterals in a file of Gmsh (.msh of format 2.2
          or 4.1): x and y of the file are x2 and x3. Orders of the elements are raised
          until the tolerance is met; the mesh itself stays.
          Stands in <section>, <station>, <defaults>. Holds <region>.

        Attributes:
          file               text, required
                             the .msh file; a relative path is from the model's
                             directory
          unit               number > 0 [m], default 1
                             length of one unit of the file, such as 1 mm
          material           text, optional
                             of elements of no <region>, their angle 0 and their N b3
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 0.001
                             the order of the elements is raised until every entry ij of
                             D changes less, over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def airfoil(self, *, unit: Value = None, corner_angle: Value = None, corners: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> AirfoilElement:
        """<airfoil>
          An aerofoil, or any section of walls along a closed curve, with webs between
          them. <points> are those of its outer surface, x2 and x3 in turn, all round
          from any of them, either way; between corners they are joined by smooth curves
          (cubic splines). Plies lie inside, at constant distances from the curve.
          Stands in <section>, <station>, <defaults>. Holds <points>, <sector>, <web>,
          <repeat>.

        Attributes:
          unit               number > 0 [m], default 1
                             length of one unit of its points: such as 1 mm, or the
                             chord
          corner_angle       number from 0 to 3.141592653589793 [rad], default
                             1.0471975511965976
                             where the line from point to point turns by more there are
                             corners; 0: straight lines between all points
          corners            mitred or butt, default mitred
                             mitred: plies turn round them; butt: walls of a box across
                             b3 go through, those across b2 stand between them; of an
                             airfoil, the wall of the sector that is listed first goes
                             through, in one sector the wall before the corner (corners
                             that point inward are mitred)
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-04
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def repeat(self, *, count: Value = None, index: Value = None) -> RepeatElement:
        """Reads its contents several times."""
        ...

class StationElement(Element):
    def stiffness(self, content: Value = None, /, *, EA: Value = None, GA2: Value = None, GA3: Value = None, GJ: Value = None, EI2: Value = None, EI3: Value = None, D12: Value = None, D13: Value = None, D14: Value = None, D15: Value = None, D16: Value = None, D23: Value = None, D24: Value = None, D25: Value = None, D26: Value = None, D34: Value = None, D35: Value = None, D36: Value = None, D45: Value = None, D46: Value = None, D56: Value = None) -> StiffnessElement:
        """<stiffness>
          D, from strains [stretch, shears; twist, curvatures] to [N1 Q2 Q3; M1 M2 M3]:
          its entries by name, the first six at least, or all of them row by row.
          Stands in <section>, <station>, <defaults>. Its text: 36 numbers.

        Attributes:
          EA                 number > 0, or inf [N], optional
                             D11, axial; as all of the diagonal it may be inf: no
                             compliance, the strain is zero
          GA2                number > 0, or inf [N], optional
                             D22, shear along b2
          GA3                number > 0, or inf [N], optional
                             D33, shear along b3
          GJ                 number > 0, or inf [N.m2], optional
                             D44, torsion
          EI2                number > 0, or inf [N.m2], optional
                             D55, bending about b2
          EI3                number > 0, or inf [N.m2], optional
                             D66, bending about b3
          D12                number [N], default 0
                             coupling of extension and shear along b2; D21 is the same,
                             and so below
          D13                number [N], default 0
                             coupling of extension and shear along b3
          D14                number [N.m], default 0
                             coupling of extension and twist
          D15                number [N.m], default 0
                             coupling of extension and bending about b2
          D16                number [N.m], default 0
                             coupling of extension and bending about b3
          D23                number [N], default 0
                             coupling of shear along b2 and shear along b3
          D24                number [N.m], default 0
                             coupling of shear along b2 and twist
          D25                number [N.m], default 0
                             coupling of shear along b2 and bending about b2
          D26                number [N.m], default 0
                             coupling of shear along b2 and bending about b3
          D34                number [N.m], default 0
                             coupling of shear along b3 and twist
          D35                number [N.m], default 0
                             coupling of shear along b3 and bending about b2
          D36                number [N.m], default 0
                             coupling of shear along b3 and bending about b3
          D45                number [N.m2], default 0
                             coupling of twist and bending about b2
          D46                number [N.m2], default 0
                             coupling of twist and bending about b3
          D56                number [N.m2], default 0
                             coupling of bending about b2 and bending about b3

        For example:
          <mbd name="mast">
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
        """
        ...
    def mass(self, *, per_length: Value = None, inertia: Value = None, center: Value = None) -> MassElement:
        """<mass>
          M per length about the reference line: [m I, -m c~; m c~, J], c = (0, x2, x3).
          Stands in <section>, <station>, <defaults>.

        Attributes:
          per_length         number > 0 [kg/m], required
                             mass per unit length
          inertia            3 or 6 numbers [kg.m], required
                             per length about the reference line: J11 J22 J33 [J12 J13
                             J23]
          center             2 numbers [m], default 0 0
                             mass centre in the section: x2 x3

        For example:
          <mbd name="mast">
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
        """
        ...
    def tube(self, *, radius: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> TubeElement:
        """<tube>
          A tube: its plies lie round it, their normals point outward.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          radius             number > 0 [m], required
                             outer radius
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             of its wall, where that is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def bar(self, *, radius: Value = None, material: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> BarElement:
        """<bar>
          A solid round bar of one material, whose N is b3.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          radius             number > 0 [m], required
                             outer radius
          material           text, required
                             name of its material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def rectangle(self, *, width: Value = None, height: Value = None, layup: Value = None, material: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> RectangleElement:
        """<rectangle>
          A solid rectangle of plies across b3, listed from below; their normal is b3.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], optional
                             along b3, of one material; with a layup it is the thickness
                             of that
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def box(self, *, width: Value = None, height: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, corners: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> BoxElement:
        """<box>
          A box with walls all round; the normals of its plies point outward.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             of its wall, where that is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          corners            mitred or butt, default mitred
                             mitred: plies turn round them; butt: walls of a box across
                             b3 go through, those across b2 stand between them; of an
                             airfoil, the wall of the sector that is listed first goes
                             through, in one sector the wall before the corner (corners
                             that point inward are mitred)
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def I(self, *, width: Value = None, height: Value = None, flange: Value = None, web: Value = None, material: Value = None, flange_thickness: Value = None, web_thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> IElement:
        """<I>
          An I: flanges across b3 at top and bottom go through, normals away from the
          middle; the web stands between them, its normal b2.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          flange             text, optional
                             name of the layup of its flanges
          web                text, optional
                             name of the layup of its web
          material           text, optional
                             name of its material, in place of plies
          flange_thickness   number > 0 [m], optional
                             of its flanges, where it is of one material
          web_thickness      number > 0 [m], optional
                             of its web, where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def C(self, *, width: Value = None, height: Value = None, flange: Value = None, web: Value = None, material: Value = None, flange_thickness: Value = None, web_thickness: Value = None, angle: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> CElement:
        """<C>
          A C: as an I, with the web at the side of -b2, its outer face at x2 = 0, its
          normal -b2.
          Stands in <section>, <station>, <defaults>.

        Attributes:
          width              number > 0 [m], required
                             outer width, along b2
          height             number > 0 [m], required
                             outer height, along b3
          flange             text, optional
                             name of the layup of its flanges
          web                text, optional
                             name of the layup of its web
          material           text, optional
                             name of its material, in place of plies
          flange_thickness   number > 0 [m], optional
                             of its flanges, where it is of one material
          web_thickness      number > 0 [m], optional
                             of its web, where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-05
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def mesh(self, *, file: Value = None, unit: Value = None, material: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> MeshElement:
        """<mesh>
          A mesh of triangles and quadrilaterals in a file of Gmsh (.msh of format 2.2
          or 4.1): x and y of the file are x2 and x3. Orders of the elements are raised
          until the tolerance is met; the mesh itself stays.
          Stands in <section>, <station>, <defaults>. Holds <region>.

        Attributes:
          file               text, required
                             the .msh file; a relative path is from the model's
                             directory
          unit               number > 0 [m], default 1
                             length of one unit of the file, such as 1 mm
          material           text, optional
                             of elements of no <region>, their angle 0 and their N b3
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 0.001
                             the order of the elements is raised until every entry ij of
                             D changes less, over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def airfoil(self, *, unit: Value = None, corner_angle: Value = None, corners: Value = None, x2: Value = None, x3: Value = None, turn: Value = None, curvature: Value = None, tolerance: Value = None) -> AirfoilElement:
        """<airfoil>
          An aerofoil, or any section of walls along a closed curve, with webs between
          them. <points> are those of its outer surface, x2 and x3 in turn, all round
          from any of them, either way; between corners they are joined by smooth curves
          (cubic splines). Plies lie inside, at constant distances from the curve.
          Stands in <section>, <station>, <defaults>. Holds <points>, <sector>, <web>,
          <repeat>.

        Attributes:
          unit               number > 0 [m], default 1
                             length of one unit of its points: such as 1 mm, or the
                             chord
          corner_angle       number from 0 to 3.141592653589793 [rad], default
                             1.0471975511965976
                             where the line from point to point turns by more there are
                             corners; 0: straight lines between all points
          corners            mitred or butt, default mitred
                             mitred: plies turn round them; butt: walls of a box across
                             b3 go through, those across b2 stand between them; of an
                             airfoil, the wall of the sector that is listed first goes
                             through, in one sector the wall before the corner (corners
                             that point inward are mitred)
          x2                 number [m], default 0
                             where its centre lies along b2 (of a C: its outer face and
                             half its height; of a mesh or an airfoil: the origin of its
                             points)
          x3                 number [m], default 0
                             where its centre lies along b3
          turn               number [rad], default 0
                             turns it about its centre, from b2 towards b3
          curvature          3 numbers [1/m], default 0 0 0
                             k1 k2 k3 of the stress-free reference line along b1 b2 b3:
                             its twist and curvatures, which D and M take into account.
                             They are not taken from the beam
          tolerance          number from 1e-10 to 0.1, default 1e-04
                             the mesh is refined until every entry ij of D changes less,
                             over sqrt(Dii Djj)

        For example:
          <mbd name="composite_tube">
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
        """
        ...

class StiffnessElement(Element):
    ...

class MassElement(Element):
    ...

class DampingElement(Element):
    ...

class TubeElement(Element):
    ...

class BarElement(Element):
    ...

class RectangleElement(Element):
    ...

class BoxElement(Element):
    ...

class IElement(Element):
    ...

class CElement(Element):
    ...

class MeshElement(Element):
    def region(self, *, name: Value = None, material: Value = None, angle: Value = None, normal: Value = None) -> RegionElement:
        """<region>
          What the elements of a physical surface of a mesh consist of.
          Stands in <mesh>, <defaults>.

        Attributes:
          name               text, required
                             of the physical surface in the file, or its number where it
                             has no name
          material           text, required
                             name of its material
          angle              number [rad], default 0
                             theta, of its L from b1, as of a ply
          normal             number [rad], default 1.5707963267948966
                             direction of its N: angle from b2 towards b3, before the
                             section is turned

        For example:
          <mbd name="composite_tube">
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
        """
        ...

class RegionElement(Element):
    ...

class AirfoilElement(Element):
    def points(self, content: Value = None, /) -> PointsElement:
        """<points>
          The points of the outer surface of an airfoil: x2 and x3 in turn, in its unit,
          all round; three or more, the last not the first again.
          Stands in <airfoil>. Its text: pairs of numbers.

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def sector(self, *, from_: Value = None, to: Value = None, from_point: Value = None, to_point: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, bare: Value = None) -> SectorElement:
        """<sector>
          A part of the contour of an airfoil, in the order of its points: its plies lie
          inside the contour, their normals point outward. Sectors cover the contour,
          none twice.
          Stands in <airfoil>, <repeat>, <defaults>.

        Attributes:
          from               number from 0 to 1, optional
                             where it begins: fraction of the length of the contour,
                             from its first point on (default: 0)
          to                 number from 0 to 1, optional
                             where it ends (default: 1); if that is not beyond from, it
                             goes through the first point
          from_point         whole number from 1 to 1000000, optional
                             in place of from: the number of a point, 1 for the first
          to_point           whole number from 1 to 1000000, optional
                             in place of to: the number of a point
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          bare               off or on, default off
                             on: there is no wall, the section is open

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def web(self, *, from_: Value = None, to: Value = None, from_point: Value = None, to_point: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None) -> WebElement:
        """<web>
          A straight wall between two places of the contour of an airfoil. Its plies lie
          about the line between these, their normal to the right of who goes from the
          first to the second (b2 to the right, b3 up); it stands on the inner surfaces
          of the walls. On a border of two sectors it stands on the thicker one (of
          alike ones on that which is listed first), which then reaches to the far edge
          of its foot.
          Stands in <airfoil>, <repeat>, <defaults>.

        Attributes:
          from               number from 0 to 1, optional
                             its first end: fraction of the length of the contour, from
                             its first point on
          to                 number from 0 to 1, optional
                             its second end
          from_point         whole number from 1 to 1000000, optional
                             in place of from: the number of a point, 1 for the first
          to_point           whole number from 1 to 1000000, optional
                             in place of to: the number of a point
          layup              text, optional
                             name of its layup; from the inside, the first ply is the
                             one its normal points away from
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def repeat(self, *, count: Value = None, index: Value = None) -> RepeatElement:
        """Reads its contents several times."""
        ...

class PointsElement(Element):
    ...

class SectorElement(Element):
    ...

class WebElement(Element):
    ...

class BeamElement(Element):
    def shape(self, *, box: Value = None, cylinder: Value = None, sphere: Value = None, mesh: Value = None, unit: Value = None, at: Value = None, orientation: Value = None, density: Value = None, rectangle: Value = None, ellipse: Value = None, to: Value = None, colour: Value = None) -> ShapeElement:
        """<shape>
          What a body or a beam looks like, for the eye: pages, pictures and files for
          ParaView. Of a body with a density it is also its mass.
          Stands in <body>, <beam>, <arc>, <curve>, <defaults>.

        Attributes:
          box                3 numbers, each > 0 [m], optional
                             of a body: its sides along the axes of the shape
          cylinder           2 numbers, each > 0 [m], optional
                             of a body: diameter and length, which lies along the third
                             axis
          sphere             number > 0 [m], optional
                             of a body: diameter
          mesh               text, optional
                             of a body: a file of triangles, .stl, .obj, .gltf or .glb;
                             a relative path is from the model's directory. The file's
                             origin and axes are those of the shape
          unit               number > 0 [m], optional
                             length of one unit of the mesh's file, such as 1 mm
                             (default 1 m)
          at                 3 numbers [m], optional
                             middle of the form (of a mesh: its origin) from the
                             reference point, body axes (default 0 0 0)
          orientation        3 or 9 numbers [rad], optional
                             axes of the shape in the body's: rotation vector, or
                             (without unit) matrix row by row
          density            number > 0 [kg/m3], optional
                             of a body: the form is solid and adds its mass and inertia
                             to those stated
          rectangle          2 numbers, each > 0 [m], optional
                             of a beam: sides along b2 and b3, in place of those that
                             its stiffness suggests
          ellipse            2 numbers, each > 0 [m], optional
                             of a beam: diameters along b2 and b3
          to                 2 numbers, each > 0 [m], optional
                             of a beam: sides or diameters at its end (default: as at
                             the start)
          colour             text, optional
                             #rrggbb, or one of the 17 names of CSS: black silver gray
                             white maroon red purple fuchsia green lime olive yellow
                             navy blue teal aqua orange. A shape that states nothing
                             else colours what is drawn without it

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...

class ArcElement(Element):
    def shape(self, *, box: Value = None, cylinder: Value = None, sphere: Value = None, mesh: Value = None, unit: Value = None, at: Value = None, orientation: Value = None, density: Value = None, rectangle: Value = None, ellipse: Value = None, to: Value = None, colour: Value = None) -> ShapeElement:
        """<shape>
          What a body or a beam looks like, for the eye: pages, pictures and files for
          ParaView. Of a body with a density it is also its mass.
          Stands in <body>, <beam>, <arc>, <curve>, <defaults>.

        Attributes:
          box                3 numbers, each > 0 [m], optional
                             of a body: its sides along the axes of the shape
          cylinder           2 numbers, each > 0 [m], optional
                             of a body: diameter and length, which lies along the third
                             axis
          sphere             number > 0 [m], optional
                             of a body: diameter
          mesh               text, optional
                             of a body: a file of triangles, .stl, .obj, .gltf or .glb;
                             a relative path is from the model's directory. The file's
                             origin and axes are those of the shape
          unit               number > 0 [m], optional
                             length of one unit of the mesh's file, such as 1 mm
                             (default 1 m)
          at                 3 numbers [m], optional
                             middle of the form (of a mesh: its origin) from the
                             reference point, body axes (default 0 0 0)
          orientation        3 or 9 numbers [rad], optional
                             axes of the shape in the body's: rotation vector, or
                             (without unit) matrix row by row
          density            number > 0 [kg/m3], optional
                             of a body: the form is solid and adds its mass and inertia
                             to those stated
          rectangle          2 numbers, each > 0 [m], optional
                             of a beam: sides along b2 and b3, in place of those that
                             its stiffness suggests
          ellipse            2 numbers, each > 0 [m], optional
                             of a beam: diameters along b2 and b3
          to                 2 numbers, each > 0 [m], optional
                             of a beam: sides or diameters at its end (default: as at
                             the start)
          colour             text, optional
                             #rrggbb, or one of the 17 names of CSS: black silver gray
                             white maroon red purple fuchsia green lime olive yellow
                             navy blue teal aqua orange. A shape that states nothing
                             else colours what is drawn without it

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...

class CurveElement(Element):
    def point(self, *, at: Value = None, normal: Value = None, twist: Value = None) -> PointElement:
        """<point>
          A point of a curve.
          Stands in <curve>, <repeat>, <defaults>.

        Attributes:
          at                 3 numbers [m], required
                             position
          normal             3 numbers, optional
                             b3 there (default: the normal of the curve)
          twist              number [rad], default 0
                             turns the section, right-handed about the tangent

        For example:
          <mbd name="hook">
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
        """
        ...
    def shape(self, *, box: Value = None, cylinder: Value = None, sphere: Value = None, mesh: Value = None, unit: Value = None, at: Value = None, orientation: Value = None, density: Value = None, rectangle: Value = None, ellipse: Value = None, to: Value = None, colour: Value = None) -> ShapeElement:
        """<shape>
          What a body or a beam looks like, for the eye: pages, pictures and files for
          ParaView. Of a body with a density it is also its mass.
          Stands in <body>, <beam>, <arc>, <curve>, <defaults>.

        Attributes:
          box                3 numbers, each > 0 [m], optional
                             of a body: its sides along the axes of the shape
          cylinder           2 numbers, each > 0 [m], optional
                             of a body: diameter and length, which lies along the third
                             axis
          sphere             number > 0 [m], optional
                             of a body: diameter
          mesh               text, optional
                             of a body: a file of triangles, .stl, .obj, .gltf or .glb;
                             a relative path is from the model's directory. The file's
                             origin and axes are those of the shape
          unit               number > 0 [m], optional
                             length of one unit of the mesh's file, such as 1 mm
                             (default 1 m)
          at                 3 numbers [m], optional
                             middle of the form (of a mesh: its origin) from the
                             reference point, body axes (default 0 0 0)
          orientation        3 or 9 numbers [rad], optional
                             axes of the shape in the body's: rotation vector, or
                             (without unit) matrix row by row
          density            number > 0 [kg/m3], optional
                             of a body: the form is solid and adds its mass and inertia
                             to those stated
          rectangle          2 numbers, each > 0 [m], optional
                             of a beam: sides along b2 and b3, in place of those that
                             its stiffness suggests
          ellipse            2 numbers, each > 0 [m], optional
                             of a beam: diameters along b2 and b3
          to                 2 numbers, each > 0 [m], optional
                             of a beam: sides or diameters at its end (default: as at
                             the start)
          colour             text, optional
                             #rrggbb, or one of the 17 names of CSS: black silver gray
                             white maroon red purple fuchsia green lime olive yellow
                             navy blue teal aqua orange. A shape that states nothing
                             else colours what is drawn without it

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...
    def repeat(self, *, count: Value = None, index: Value = None) -> RepeatElement:
        """Reads its contents several times."""
        ...

class PointElement(Element):
    ...

class BodyElement(Element):
    def shape(self, *, box: Value = None, cylinder: Value = None, sphere: Value = None, mesh: Value = None, unit: Value = None, at: Value = None, orientation: Value = None, density: Value = None, rectangle: Value = None, ellipse: Value = None, to: Value = None, colour: Value = None) -> ShapeElement:
        """<shape>
          What a body or a beam looks like, for the eye: pages, pictures and files for
          ParaView. Of a body with a density it is also its mass.
          Stands in <body>, <beam>, <arc>, <curve>, <defaults>.

        Attributes:
          box                3 numbers, each > 0 [m], optional
                             of a body: its sides along the axes of the shape
          cylinder           2 numbers, each > 0 [m], optional
                             of a body: diameter and length, which lies along the third
                             axis
          sphere             number > 0 [m], optional
                             of a body: diameter
          mesh               text, optional
                             of a body: a file of triangles, .stl, .obj, .gltf or .glb;
                             a relative path is from the model's directory. The file's
                             origin and axes are those of the shape
          unit               number > 0 [m], optional
                             length of one unit of the mesh's file, such as 1 mm
                             (default 1 m)
          at                 3 numbers [m], optional
                             middle of the form (of a mesh: its origin) from the
                             reference point, body axes (default 0 0 0)
          orientation        3 or 9 numbers [rad], optional
                             axes of the shape in the body's: rotation vector, or
                             (without unit) matrix row by row
          density            number > 0 [kg/m3], optional
                             of a body: the form is solid and adds its mass and inertia
                             to those stated
          rectangle          2 numbers, each > 0 [m], optional
                             of a beam: sides along b2 and b3, in place of those that
                             its stiffness suggests
          ellipse            2 numbers, each > 0 [m], optional
                             of a beam: diameters along b2 and b3
          to                 2 numbers, each > 0 [m], optional
                             of a beam: sides or diameters at its end (default: as at
                             the start)
          colour             text, optional
                             #rrggbb, or one of the 17 names of CSS: black silver gray
                             white maroon red purple fuchsia green lime olive yellow
                             navy blue teal aqua orange. A shape that states nothing
                             else colours what is drawn without it

        For example:
          <mbd name="top_and_rotor">
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
        """
        ...

class ShapeElement(Element):
    ...

class DriveElement(Element):
    ...

class MotionElement(Element):
    ...

class LoadElement(Element):
    ...

class DistributedElement(Element):
    ...

class RigidElement(Element):
    ...

class PointMassElement(Element):
    ...

class SpringElement(Element):
    def table(self, content: Value = None, /, *, of: Value = None, interpolation: Value = None) -> TableElement:
        """<table>
          A law in place of an expression: x and force (or v and force) in turn, in SI
          units, x rising.
          Stands in <spring>, <joint_spring>. Its text: pairs of numbers.

        Attributes:
          of                 force, damping_force, moment or damping_moment, default
                             force
                             what it gives, as the attribute of that name
          interpolation      linear or smooth, default linear
                             between its points: linear or a cubic spline; linear beyond
                             the first and the last

        For example:
          <mbd name="gate">
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
        """
        ...

class BushingElement(Element):
    def matrix(self, content: Value = None, /, *, of: Value = None) -> MatrixElement:
        """<matrix>
          Its stiffness or damping, symmetric, in place of the attributes: row by row,
          displacements before rotations, in SI units.
          Stands in <bushing>. Its text: 36 numbers.

        Attributes:
          of                 stiffness or damping, default stiffness
                             what it is

        For example:
          <mbd name="gate">
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
        """
        ...
    def law(self, content: Value = None, /, *, component: Value = None, force: Value = None, moment: Value = None, interpolation: Value = None) -> LawElement:
        """<law>
          What one component of its motion adds to the stiffness: an expression, or a
          table of x and force in turn, in SI units, x rising.
          Stands in <bushing>. Its text: pairs of numbers.

        Attributes:
          component          whole number from 1 to 6, required
                             of the motion of b relative to a: 1 to 3 along, 4 to 6
                             about the axes
          force              expression of x [N], optional
                             of components 1 to 3: over the displacement x [m]
          moment             expression of x [N.m], optional
                             of components 4 to 6: over the rotation x [rad]
          interpolation      linear or smooth, default linear
                             of a table: linear or a cubic spline, whose pieces meet
                             between the points; linear beyond the first and the last
                             point

        For example:
          <mbd name="gate">
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
        """
        ...

class MatrixElement(Element):
    ...

class LawElement(Element):
    ...

class JointSpringElement(Element):
    def table(self, content: Value = None, /, *, of: Value = None, interpolation: Value = None) -> TableElement:
        """<table>
          A law in place of an expression: x and force (or v and force) in turn, in SI
          units, x rising.
          Stands in <spring>, <joint_spring>. Its text: pairs of numbers.

        Attributes:
          of                 force, damping_force, moment or damping_moment, default
                             force
                             what it gives, as the attribute of that name
          interpolation      linear or smooth, default linear
                             between its points: linear or a cubic spline; linear beyond
                             the first and the last

        For example:
          <mbd name="gate">
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
        """
        ...

class JointTorqueElement(Element):
    ...

class TableElement(Element):
    ...

class DragElement(Element):
    ...

class AddedMassElement(Element):
    ...

class ExtensionElement(Element):
    ...

class BaseMotionElement(Element):
    ...

class GravityElement(Element):
    ...

class StaticElement(Element):
    ...

class PathElement(Element):
    def mark(self, *, quantity: Value = None, value: Value = None) -> MarkElement:
        """<mark>
          A point of the path to be located, shown and drawn: where a column passes a
          value.
          Stands in <path>, <repeat>, <defaults>.

        Attributes:
          quantity           text, required
                             a column of path.csv
          value              number [any unit], required
                             the value it passes, from either side

        For example:
          <mbd name="snap_through">
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
        """
        ...
    def stop(self, *, quantity: Value = None, value: Value = None) -> StopElement:
        """<stop>
          A mark at which the path ends.
          Stands in <path>, <repeat>, <defaults>.

        Attributes:
          quantity           text, required
                             a column of path.csv
          value              number [any unit], required
                             the value it passes, from either side

        For example:
          <mbd name="snap_through">
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
        """
        ...

class MarkElement(Element):
    ...

class StopElement(Element):
    ...

class TransientElement(Element):
    ...

class ModesElement(Element):
    ...

class RecordElement(Element):
    ...

class MotionOutputElement(Element):
    ...

class PlotElement(Element):
    ...

class ExpectElement(Element):
    ...

class RepeatElement(Element):
    def material(self, *, name: Value = None, E: Value = None, nu: Value = None, EL: Value = None, ET: Value = None, EN: Value = None, GLT: Value = None, GLN: Value = None, GTN: Value = None, nuLT: Value = None, nuLN: Value = None, nuTN: Value = None, rho: Value = None, yield_: Value = None, Xt: Value = None, Xc: Value = None, Yt: Value = None, Yc: Value = None, SLT: Value = None, STN: Value = None, Zt: Value = None, Zc: Value = None, SLN: Value = None) -> MaterialElement:
        """A linear elastic material, of which sections are made: isotropic by E and nu; else along its axes, L along the fibres, N across the ply, T = N x L, by EL, ET, GLT, nuLT, nuTN, and what differs along N."""
        ...
    def layup(self, *, name: Value = None, listed: Value = None) -> LayupElement:
        """The plies of a wall, one after the other."""
        ...
    def ply(self, *, material: Value = None, thickness: Value = None, angle: Value = None) -> PlyElement:
        """<ply>
          A ply of a layup.
          Stands in <layup>, <repeat>, <defaults>.

        Attributes:
          material           text, required
                             name of its material
          thickness          number > 0 [m], required
                             its thickness
          angle              number [rad], default 0
                             theta, of its L from b1: L = cos(theta) b1 + sin(theta) (n
                             x b1), right-handed about the outward normal n of the wall

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def section(self, *, name: Value = None, interpolation: Value = None) -> SectionElement:
        """Stiffness and mass of a cross-section, axes b1 (along the beam) b2 b3."""
        ...
    def station(self, *, at: Value = None) -> StationElement:
        """<station>
          The section at one place of the beam; two or more, from 0 to 1, in order.
          Stands in <section>, <repeat>, <defaults>. Holds <stiffness>, <mass>, <tube>,
          <bar>, <rectangle>, <box>, <I>, <C>, <mesh>, <airfoil>.

        Attributes:
          at                 number from 0 to 1, required
                             fraction of the reference length of the beam

        For example:
          <mbd name="mast">
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
        """
        ...
    def sector(self, *, from_: Value = None, to: Value = None, from_point: Value = None, to_point: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None, bare: Value = None) -> SectorElement:
        """<sector>
          A part of the contour of an airfoil, in the order of its points: its plies lie
          inside the contour, their normals point outward. Sectors cover the contour,
          none twice.
          Stands in <airfoil>, <repeat>, <defaults>.

        Attributes:
          from               number from 0 to 1, optional
                             where it begins: fraction of the length of the contour,
                             from its first point on (default: 0)
          to                 number from 0 to 1, optional
                             where it ends (default: 1); if that is not beyond from, it
                             goes through the first point
          from_point         whole number from 1 to 1000000, optional
                             in place of from: the number of a point, 1 for the first
          to_point           whole number from 1 to 1000000, optional
                             in place of to: the number of a point
          layup              text, optional
                             name of its layup
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply
          bare               off or on, default off
                             on: there is no wall, the section is open

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def web(self, *, from_: Value = None, to: Value = None, from_point: Value = None, to_point: Value = None, layup: Value = None, material: Value = None, thickness: Value = None, angle: Value = None) -> WebElement:
        """<web>
          A straight wall between two places of the contour of an airfoil. Its plies lie
          about the line between these, their normal to the right of who goes from the
          first to the second (b2 to the right, b3 up); it stands on the inner surfaces
          of the walls. On a border of two sectors it stands on the thicker one (of
          alike ones on that which is listed first), which then reaches to the far edge
          of its foot.
          Stands in <airfoil>, <repeat>, <defaults>.

        Attributes:
          from               number from 0 to 1, optional
                             its first end: fraction of the length of the contour, from
                             its first point on
          to                 number from 0 to 1, optional
                             its second end
          from_point         whole number from 1 to 1000000, optional
                             in place of from: the number of a point, 1 for the first
          to_point           whole number from 1 to 1000000, optional
                             in place of to: the number of a point
          layup              text, optional
                             name of its layup; from the inside, the first ply is the
                             one its normal points away from
          material           text, optional
                             name of its material, in place of plies
          thickness          number > 0 [m], optional
                             where it is of one material
          angle              number [rad], default 0
                             theta of a material that is given by itself, as of a ply

        For example:
          <mbd name="composite_tube">
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
        """
        ...
    def beam(self, *, name: Value = None, section: Value = None, from_: Value = None, to: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> BeamElement:
        """A straight beam."""
        ...
    def arc(self, *, name: Value = None, section: Value = None, from_: Value = None, center: Value = None, axis: Value = None, angle: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> ArcElement:
        """A beam along a circular arc: `from`, turned about the centre."""
        ...
    def curve(self, *, name: Value = None, section: Value = None, degree: Value = None, normal: Value = None, elements: Value = None, mesh: Value = None, order: Value = None, kinematics: Value = None, metric: Value = None, rule: Value = None, form: Value = None) -> CurveElement:
        """A beam along a smooth curve through points."""
        ...
    def point(self, *, at: Value = None, normal: Value = None, twist: Value = None) -> PointElement:
        """<point>
          A point of a curve.
          Stands in <curve>, <repeat>, <defaults>.

        Attributes:
          at                 3 numbers [m], required
                             position
          normal             3 numbers, optional
                             b3 there (default: the normal of the curve)
          twist              number [rad], default 0
                             turns the section, right-handed about the tangent

        For example:
          <mbd name="hook">
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
        """
        ...
    def body(self, *, name: Value = None, attached_to: Value = None, at: Value = None, orientation: Value = None, mass: Value = None, center: Value = None, inertia: Value = None, velocity: Value = None, angular_velocity: Value = None) -> BodyElement:
        """A rigid body, free or fixed to a place."""
        ...
    def drive(self, *, joint: Value = None, rate: Value = None, angle: Value = None, speed: Value = None, displacement: Value = None) -> DriveElement:
        """Prescribes the angle or the displacement of a joint."""
        ...
    def motion(self, *, name: Value = None, of: Value = None, displacement: Value = None, velocity: Value = None, rotation: Value = None, axis: Value = None, angle: Value = None, rate: Value = None) -> MotionElement:
        """Prescribes the motion of a place; what is not given is free."""
        ...
    def load(self, *, name: Value = None, at: Value = None, force: Value = None, moment: Value = None, follower_force: Value = None, follower_moment: Value = None, offset: Value = None) -> LoadElement:
        """A force and moment at a place."""
        ...
    def distributed(self, *, name: Value = None, beam: Value = None, from_: Value = None, to: Value = None, force: Value = None, moment: Value = None, follower_force: Value = None, follower_moment: Value = None) -> DistributedElement:
        """Forces and moments per unit of reference length along a beam; expressions of s, the fraction of that length, and t."""
        ...
    def rigid(self, *, name: Value = None, of: Value = None) -> RigidElement:
        """Makes one rigid body of beams and free bodies: one node with the mass of them all. Places of its beams stay places; joints between two of them do nothing."""
        ...
    def point_mass(self, *, name: Value = None, at: Value = None, mass: Value = None, offset: Value = None) -> PointMassElement:
        """A mass without inertia of its own that moves with a place."""
        ...
    def spring(self, *, name: Value = None, between: Value = None, at_a: Value = None, at_b: Value = None, stiffness: Value = None, damping: Value = None, length: Value = None, force: Value = None, damping_force: Value = None) -> SpringElement:
        """A spring, a damper or both along the line between two points of two places."""
        ...
    def bushing(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, second_axis: Value = None, stiffness: Value = None, angular_stiffness: Value = None, damping: Value = None, angular_damping: Value = None) -> BushingElement:
        """An elastic connection of two frames, which coincide in the reference configuration, in all six directions."""
        ...
    def joint_spring(self, *, name: Value = None, joint: Value = None, angular_stiffness: Value = None, angular_damping: Value = None, rest_angle: Value = None, moment: Value = None, damping_moment: Value = None, stiffness: Value = None, damping: Value = None, rest_displacement: Value = None, force: Value = None, damping_force: Value = None) -> JointSpringElement:
        """A spring, a damper or both on the free coordinate of a joint: its angle, over any number of turns, or its displacement."""
        ...
    def joint_torque(self, *, name: Value = None, joint: Value = None, moment: Value = None, force: Value = None) -> JointTorqueElement:
        """A moment about or a force along the axis of a joint, of time; the joint turns freely."""
        ...
    def drag(self, *, name: Value = None, density: Value = None, flow: Value = None, beam: Value = None, from_: Value = None, to: Value = None, diameter: Value = None, normal_coefficient: Value = None, tangential_coefficient: Value = None, at: Value = None, area: Value = None, coefficient: Value = None, offset: Value = None) -> DragElement:
        """Quadratic drag of a fluid, still or flowing, along a beam or at a place."""
        ...
    def added_mass(self, *, name: Value = None, beam: Value = None, from_: Value = None, to: Value = None, density: Value = None, diameter: Value = None, coefficient: Value = None, at: Value = None, matrix: Value = None) -> AddedMassElement:
        """Inertia of a fluid that a beam or a body sets in motion: of a fluid at rest, without its weight."""
        ...
    def extension(self, *, name: Value = None, force: Value = None, at: Value = None, values: Value = None) -> ExtensionElement:
        """A force that a plug-in computes, as `mbd run --plugin FILE` gives it (libmbd/plugin.h)."""
        ...
    def mark(self, *, quantity: Value = None, value: Value = None) -> MarkElement:
        """<mark>
          A point of the path to be located, shown and drawn: where a column passes a
          value.
          Stands in <path>, <repeat>, <defaults>.

        Attributes:
          quantity           text, required
                             a column of path.csv
          value              number [any unit], required
                             the value it passes, from either side

        For example:
          <mbd name="snap_through">
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
        """
        ...
    def stop(self, *, quantity: Value = None, value: Value = None) -> StopElement:
        """<stop>
          A mark at which the path ends.
          Stands in <path>, <repeat>, <defaults>.

        Attributes:
          quantity           text, required
                             a column of path.csv
          value              number [any unit], required
                             the value it passes, from either side

        For example:
          <mbd name="snap_through">
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
        """
        ...
    def record(self, *, name: Value = None, at: Value = None, joint: Value = None, spring: Value = None, section_point: Value = None, quantities: Value = None) -> RecordElement:
        """Columns of history.csv."""
        ...
    def plot(self, *, x: Value = None, y: Value = None, x_scale: Value = None, y_scale: Value = None, x_label: Value = None, y_label: Value = None, title: Value = None, x_range: Value = None) -> PlotElement:
        """A panel of history.svg."""
        ...
    def expect(self, *, quantity: Value = None, of: Value = None, number: Value = None, at: Value = None, value: Value = None, tolerance: Value = None, source: Value = None, when: Value = None) -> ExpectElement:
        """A number the run must give."""
        ...
    def repeat(self, *, count: Value = None, index: Value = None) -> RepeatElement:
        """Reads its contents several times."""
        ...
    def input(self, *, name: Value = None, unit: Value = None, value: Value = None) -> InputElement:
        """A value that a program sets while the model runs; the laws of loads, joint torques, flows and drives use it by its name, as they use t. In a run of `mbd run` it keeps its `value`."""
        ...
    def function(self, content: Value = None, /, *, name: Value = None, value: Value = None, unit: Value = None, interpolation: Value = None) -> FunctionElement:
        """A function of time that the laws of loads, drives and controllers call by its name, as ref(t) or ref(2*t+1): an expression, or as text a table of t [s] and its value in turn, t rising."""
        ...
    def controller(self, *, name: Value = None, period: Value = None) -> ControllerElement:
        """Samples the motion at t = 0, period, 2 period, … and holds its outputs until the next instant: what it consists of is evaluated in its order, with states as they were; what it gives acts from that instant on, without delay. Steps end there."""
        ...
    def reduction(self, *, name: Value = None, of: Value = None, modes: Value = None, frame: Value = None) -> ReductionElement:
        """Makes one element of component modes (Craig-Bampton) of beams and bodies, with what is fixed between them: static shapes of the places where something acts, and the slowest modes with these held. For parts that deform little, whatever their motion; what tension or compression change of their stiffness is only about right (the certificate says what that makes). Without it they are the beams they are."""
        ...
    def fixed(self, *, name: Value = None, between: Value = None, at: Value = None) -> FixedElement:
        """Nothing is left free."""
        ...
    def rigid_link(self, *, name: Value = None, between: Value = None, at: Value = None) -> RigidLinkElement:
        """A rigid, massless arm between two places at any distance."""
        ...
    def revolute(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> RevoluteElement:
        """One rotation is left free, about the axis."""
        ...
    def prismatic(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PrismaticElement:
        """One translation is left free, along the axis."""
        ...
    def cylindrical(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> CylindricalElement:
        """One rotation and one translation are left free, about and along the axis."""
        ...
    def screw(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, pitch: Value = None) -> ScrewElement:
        """Turning about the axis advances along it by the pitch a turn."""
        ...
    def universal(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None, second_axis: Value = None) -> UniversalElement:
        """Two rotations are left free, about an axis fixed in a and one fixed in b."""
        ...
    def spherical(self, *, name: Value = None, between: Value = None, at: Value = None) -> SphericalElement:
        """Three rotations are left free."""
        ...
    def planar(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PlanarElement:
        """Two translations and one rotation are left free, in a plane."""
        ...
    def point_on_line(self, *, name: Value = None, between: Value = None, at: Value = None, axis: Value = None) -> PointOnLineElement:
        """A point of a stays on a line of b."""
        ...
    def distance(self, *, name: Value = None, between: Value = None, at_a: Value = None, at_b: Value = None) -> DistanceElement:
        """A massless rod with ball joints at its ends."""
        ...

class StateElement(Element):
    ...

class OutputElement(Element):
    ...

class PidElement(Element):
    ...

class StateSpaceElement(Element):
    ...

class InputElement(Element):
    ...

class FunctionElement(Element):
    ...

class ControllerElement(Element):
    def state(self, *, name: Value = None, start: Value = None, next: Value = None) -> StateElement:
        """<state>
          A number that a controller keeps from one instant to the next.
          Stands in <controller>.

        Attributes:
          name               text, required
                             what expressions of its controller call it
          start              number, default 0
                             at the first instant
          next               expression of t [any unit], required
                             at the next instant, of t, sensors, inputs and the states
                             as they are now

        For example:
          <mbd name="two_carts">
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
        """
        ...
    def output(self, *, name: Value = None, start: Value = None, value: Value = None) -> OutputElement:
        """<output>
          What a controller gives: laws use it by its name, as an input.
          Stands in <controller>.

        Attributes:
          name               text, required
                             what laws after it call it: letters, digits and _
          start              number [any unit], default 0
                             before the first instant, and in a <static>
          value              expression of t [any unit], required
                             from the instant on until the next: an expression of t,
                             sensors, inputs, states and outputs before it, in SI units
                             or the one behind it

        For example:
          <mbd name="two_carts">
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
        """
        ...
    def pid(self, *, name: Value = None, error: Value = None, proportional: Value = None, integral: Value = None, derivative: Value = None, filter: Value = None, limits: Value = None, start: Value = None) -> PidElement:
        """<pid>
          A PID controller: an output with an integrator and a filtered derivative.
          Stands in <controller>.

        Attributes:
          name               text, required
                             of its output: what laws after it call it: letters, digits
                             and _
          error              expression of t [any unit], required
                             what it is to bring to 0, as ref(t)-elbow.angle: an
                             expression as of an output
          proportional       number [any unit], default 0
                             output per error
          integral           number [any unit], default 0
                             rate of the output per error
          derivative         number [any unit], default 0
                             output per rate of the error
          filter             number >= 0 [s], default 0
                             time constant of the derivative
          limits             2 numbers [any unit], optional
                             least and largest output; while it is there, the integrator
                             does not run further into them
          start              number [any unit], default 0
                             of the integrator, and the output before the first instant

        For example:
          <mbd name="two_carts">
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
        """
        ...
    def state_space(self, *, inputs: Value = None, outputs: Value = None, A: Value = None, B: Value = None, C: Value = None, D: Value = None, start: Value = None) -> StateSpaceElement:
        """<state_space>
          Outputs y = C x + D w of states x, which at the next instant are A x + B w, w
          the values of expressions. Matrices row by row.
          Stands in <controller>.

        Attributes:
          inputs             text, required
                             w: expressions as of an output, separated by blanks, which
                             they do not contain
          outputs            words, required
                             y: what laws after it call them
          A                  text, optional
                             of states by states (none: there are no states)
          B                  text, optional
                             of states by inputs
          C                  text, optional
                             of outputs by states
          D                  text, optional
                             of outputs by inputs (default 0)
          start              text, optional
                             of the states (default 0)

        For example:
          <mbd name="two_carts">
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
        """
        ...

class ReductionElement(Element):
    ...

class FixedElement(Element):
    ...

class RigidLinkElement(Element):
    ...

class RevoluteElement(Element):
    ...

class PrismaticElement(Element):
    ...

class CylindricalElement(Element):
    ...

class ScrewElement(Element):
    ...

class UniversalElement(Element):
    ...

class SphericalElement(Element):
    ...

class PlanarElement(Element):
    ...

class PointOnLineElement(Element):
    ...

class DistanceElement(Element):
    ...

def accuracy(model: Any, *, set: Any = None, quantities: Any = (), vary: Any = None, reference: Any = None, budget: Any = 120.0, refinements: Any = None) -> Dict[str, Any]:
    """Error against CPU time of many settings, and the cheapest for each accuracy: dict, as `mbd accuracy` writes
    accuracy.json.

    model: file, Scene or Model; set: values of parameters
    quantities: whose error, names of columns, quantities or records; none: what the model expects, plots or records
    vary: {"order": [2, 3], "tolerance": "1e-2:1e-8"}: values of knobs; none: those that suit the model
    reference: CSV file in place of a reference made here
    budget: seconds for it all; refinements: of the reference, at most

    Raises ModelError, UseError, and Interrupted with the study so far.
    """
    ...

def campbell(model: Any, rates: Any, *, set: Any = None, points: Any = 61, count: Any = 8, axis: Any = None, through: Any = None, at_rest: Any = (), without: Any = (), unbalance: Any = None, forces: Any = None, order: Any = 1, probes: Any = ()) -> Dict[str, Any]:
    """Modes followed over the rate of a steady rotation, and responses at the same rates.

    rates: (first, last) [rad/s], or texts with units ("0 rpm", "600 rpm"); points: how many at least
    count: modes; axis, through, at_rest, without as of modes()
    unbalance: {place: mass times distance from the axis [kg.m]} of what turns
    forces: {place: amplitude, or (along e2, along e3) [N]}, of fixed direction, as cos(order W t)
    probes: where the responses to both are wanted besides

    Returns a dict: rates (r,) [rad/s]; displacements (r,) [m] of the steady rotation; branches, list of dicts with
    name, rates, eigenvalues (complex [1/s], in `axes`), inertial_frequencies ([rad/s], nan where orbits are not round),
    overlaps; unbalance_responses, force_responses, lists of dicts with place, rates, and amplitudes [m] of
    y + i z = forward exp(i w t) + backward exp(-i w t) (complex), besides (at other frequencies, of unround shafts);
    special, list of dicts with kind ("critical", "unstable_above", "stable_above"), rate [rad/s], branch;
    axes; notes. Raises ModelError, UseError, and Interrupted with the diagram so far.
    """
    ...

def effects(model: Any, *, set: Any = None, quantities: Any = (), tolerance: Any = 0.01, budget: Any = 120.0) -> Dict[str, Any]:
    """What each effect of a model costs and is worth, and the cheapest model within a tolerance: dict, as `mbd effects`
    writes effects.json.

    tolerance: rms change of each quantity over its largest value; budget: CPU seconds

    Raises ModelError, UseError, and Interrupted with the study so far.
    """
    ...

def linearize(model: Any, *, set: Any = None, at: Any = None, rate: Any = None, axis: Any = None, through: Any = None, at_rest: Any = (), without: Any = ()) -> Dict[str, Any]:
    """Equations of motion as matrices, from the model's inputs to all that it records: E x' = A x + B u, y = C x + D u,
    about equilibrium, or steady rotation of the whole at a rate (as of modes()), or the state of a run.

    at: time of a run [s]: then there are the matrices of all motions only
    rate, axis, through, at_rest, without as of modes()

    Returns a dict. With n states, i inputs, o outputs:
      E, A (n, n), B (n, i), C (o, n), D (o, i); states, inputs, outputs: lists of (name, unit); y (o,): outputs there
      N (k, n/2): motions of all nodes, six each, by states
      motion: M u'' + C u' + K u + G^T l = F w, G u = 0 of all nodes: M, C, K, G as ((values, (rows, columns)), shape), which
      is what scipy.sparse.coo_array takes: coo_array(*motion["K"]); F (k, i)
      notes
    Raises ModelError and UseError.
    """
    ...

def modes(model: Any, *, set: Any = None, count: Any = None, near: Any = None, rate: Any = None, at: Any = None, axis: Any = None, through: Any = None, at_rest: Any = (), without: Any = (), mac: Any = False, compare: Any = None) -> Dict[str, Any]:
    """Small motions about equilibrium, about steady rotation of the whole at a rate, or about the state of a run.

    What is not given is as <modes> of the model says, or without one:
    count: how many (10); near: those nearest to this frequency [Hz] (0)
    rate: of the rotation [rad/s] about the axis (1, 0, 0) through a point (0, 0, 0) [m]; at_rest: bodies and beams that do
    not turn; at: time of a run [s]
    without: effects to leave out, as `mbd effects` names them
    mac: how alike they are among themselves; compare: or to other modes, of a Model, a model file, or a modes.json

    Returns a dict. With n modes and k nodes (the ground left out):
      eigenvalues l (n,) complex [1/s]; frequencies (n,) [Hz], |l|/2 pi, undamped (with damping it swings at Im l/2 pi);
      damping_ratios (n,); names, list of n
      shapes (n, k, 6) complex: displacements [m] and rotations [rad], inertial axes; positions (k, 3) [m]; nodes, names
      parts: list of n dicts, shares of kinetic energy; orbits, inertial_frequencies (n,) [Hz]: nan without whirl
      residuals (n,); conditions (n,), of the eigenvalues: |dl|/|l| is at most half of it times a change of the forces
      over |l|^2 times the mass; axes: "turning", "resting" or None; notes
      mac, None or a dict: mac (n, others), weighted by mass, nan where a shape moves none: 1 the same shape, 0 nothing in
      common; groups, other_groups: lists of modes of one eigenvalue, of whose shapes any mixture is one too;
      mac_of_groups: of their spans; pairs, list of dicts with modes, others, alike (by half or more);
      other_names, other_frequencies [Hz]; notes
    Raises ModelError and UseError.
    """
    ...

def read(directory: Any) -> Results:
    """Results that `mbd run` has written: a directory, or a CSV file with a line of names."""
    ...

def rotations(model: Any, rates: Any, *, set: Any = None, axis: Any = None, through: Any = None, at_rest: Any = (), without: Any = (), probes: Any = (), search: Any = 9, points: Any = 500, far: Any = 1.0, count: Any = 8) -> Dict[str, Any]:
    """Steady rotations over their rate, through folds, and others at the same rates.

    rates: (first, last) [rad/s], or texts with units; axis, through, at_rest, without as of modes()
    probes: places whose displacement is wanted
    search: at how many rates others are sought; far: how far from one they are (mean motion of the nodes, of the
    scene's size and in rad); points: of a path at most, in each sense; count: modes that must not grow

    Returns a dict: paths, list of dicts with rates (n,) [rad/s], displacements (n,) [m] of the node that moves most,
    probes (n, places, 3) [m], growth (n,) [1/s] (nan where it is not known), unstable (n,) how many modes grow (-1: not
    known), folds (indices of points), ends; searched: rates at which others were sought; notes.
    Raises ModelError, UseError, and Interrupted with the paths so far.
    """
    ...

def sweep(model: Any, vary: Any = None, *, points: Any = None, latin: Any = None, seed: Any = 1, quantity: Any = (), set: Any = None, jobs: Any = None, share: Any = None, client: Any = None, on: Any = None, tasks: Any = None, sbatch: Any = (), wait: Any = True, out: Any = None, progress: Any = False) -> Sweep:
    """Runs a model for many values of parameters, several at once, each in a process of its own, and returns a Sweep.

    model: file, Scene or Model
    vary: {"rpm": range(10, 60), "d": ["1 mm", "2 mm"], "f": "1:10:0.5"}: all combinations, the last varies fastest
    latin: a Latin hypercube of so many points instead, in the ranges of `vary`: {"rpm": (10, 60)} or {"rpm": "10:60"}
    points: a CSV file with a line of names, or a list of dicts, instead
    quantity: columns, quantities or records, with "@minimum", "@maximum", "@largest", "@mean" or "@rms" of the rows of
      results in place of the end; none: all that is recorded
    jobs: processes at once; none: as many as there are processors, of a task of Slurm one
    share: "2/8", only every eighth point from the second on, as one of eight processes with the same `out`: the last to
      end writes the table; the others' points that are not there yet are "open"
    client: a dask.distributed.Client, whose workers run the points, each in a thread of its own, in place of processes
      here. They need this mbd, and the model's files under the same names. What a worker that dies was running runs on
      another; a point with which several have died is "lost"
    on: "slurm", to submit a job array to Slurm, a share in each of its `tasks` (none: one for each point, 100 at most), and
      wait for it; Ctrl-C ends the job. `sbatch` has options for that command, ["--partition=long"]; those of all jobs are
      better set in SBATCH_PARTITION … wait=False: submit and return; the last task writes the table in `out`, which all
      machines must see, as this mbd and the model's files
    out: directory that gets sweep.csv and keeps rows as they come: the same sweep goes on from there after Ctrl-C or a
      kill, with more or other points too
    progress: True, or a function f(done, all)

    Failures are rows. Raises ModelError where the model is wrong at any value, UseError (also for what Slurm refuses),
    RunError where tasks of Slurm ended early, and Interrupted; the last two have the Sweep so far in .results. Its processes
    are forked: meanwhile no other thread may be inside mbd.
    """
    ...
