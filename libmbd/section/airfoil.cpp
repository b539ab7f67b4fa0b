#include "libmbd/section/airfoil.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "libmbd/core/disjoint_sets.hpp"
#include "libmbd/section/cells.hpp"
#include "libmbd/section/contour.hpp"
#include "libmbd/section/crossing.hpp"
#include "libmbd/section/places.hpp"

namespace mbd::section {
namespace {

constexpr double steepest_sine = 0.2588190451025208;  // of 15 degrees, between a web and a wall

// Places from a to b whose distances follow size(x), both ends among them.
std::vector<double> spaced(double a, double b, const std::function<double(double)>& size) {
  constexpr int samples = 64;
  std::array<double, samples + 1> sum{};
  const double h = (b - a) / samples;
  for (int i = 0; i < samples; ++i)
    sum[static_cast<std::size_t>(i + 1)] =
        sum[static_cast<std::size_t>(i)] + h / size(a + (i + 0.5) * h);
  const int parts = std::max(1, static_cast<int>(std::ceil(sum.back() - 0.25)));
  std::vector<double> all{a};
  for (int k = 1; k < parts; ++k) {
    const double goal = sum.back() * k / parts;
    const auto i = static_cast<std::size_t>(std::ranges::lower_bound(sum, goal) - sum.begin());
    all.push_back(a + h * (static_cast<double>(i) - (sum[i] - goal) / (sum[i] - sum[i - 1])));
  }
  all.push_back(b);
  return all;
}

struct WallPly {
  double outer, inner;  // depths
  int material;
  double angle;
  int number;  // in its layup, from 1 on
};

// A wall between two breaks: corners, borders of sectors, interfaces of a web at its foot.
enum class End { plain, mitred, through, standing };
struct Wall {
  int piece = 0;
  double from = 0.0, to = 0.0;  // u, as the piece counts it
  int sector = 0;
  bool foot = false;
  End begin = End::plain, end = End::plain;
  std::vector<bool> marked_from, marked_to;  // at each depth
  // What a corner takes from it, at either end; and whether that is so much that lines of elements across
  // it lean as its ends do, all along, instead of standing upright next to them.
  double cut_from = 0.0, cut_to = 0.0;
  bool leaning = false;
};

struct Foot {
  int sector = -1, piece = 0;
  std::vector<double> u;  // of the web's interfaces, as the piece counts it
  double low = 0.0, high = 0.0;
};
struct Web {
  Point from, to, normal;
  // Lines along it, from the middle along the normal: interfaces, and others within thick plies; of the cells between two
  // of them, the plies.
  std::vector<double> across;
  std::vector<std::size_t> ply;
  std::vector<bool> interface;
  std::array<Foot, 2> feet;
};

class Walls {
 public:
  Walls(const Airfoil& stated, const std::vector<MeshMaterial>& materials)
      : stated_(stated), contour_(stated.points, stated.corner_angle) {
    near_ = 1e-9 * contour_.period();
    for (std::size_t s = 0; s < stated.sectors.size(); ++s)
      if (!stated.sectors[s].bare) check_plies(sector(s), "sector", materials);
    for (const AirfoilWeb& web : stated.webs) check_plies(web, "web", materials);
    cover();
    find_levels();
    for (std::size_t w = 0; w < stated.webs.size(); ++w) stand(w);
    check_feet();
    move_borders();
    break_up();
    check_radii();
    mark();
    check(cells(1));
  }

  Mesh mesh(Fineness fineness, const std::vector<MeshMaterial>& materials) const {
    // The order does more than rings do (mbd section --accuracy), and beyond most_rings() they come near to the distance at
    // which nodes are one.
    const int layers = fineness.layers;
    fineness.layers = std::min((layers + 1) / 2, most_rings());
    return mesh_of(cells(layers), fineness, materials, 1e-12 * contour_.period());
  }

 private:
  const AirfoilSector& sector(std::size_t s) const { return stated_.sectors[s]; }
  const AirfoilSector& sector(int s) const { return sector(static_cast<std::size_t>(s)); }
  [[noreturn]] static void fail(const auto& part, std::string_view kind, const std::string& what) {
    throw PartError(part.source, fmt::format("{}: {}", kind, what));
  }
  static std::string named(const auto& part, std::string_view kind, std::size_t i) {
    return part.source.line > 0 ? fmt::format("the {} on line {}", kind, part.source.line)
                                : fmt::format("{} {}", kind, i + 1);
  }
  std::string sector_name(int s) const {
    return named(sector(s), "sector", static_cast<std::size_t>(s));
  }
  std::string web_name(std::size_t w) const { return named(stated_.webs[w], "web", w); }
  static std::string near_text(const Point& x) {
    return fmt::format("near x2 = {:g}, x3 = {:g}", x(0), x(1));
  }

  static void check_plies(const auto& part, std::string_view kind,
                          const std::vector<MeshMaterial>& materials) {
    if (part.layup.empty()) fail(part, kind, "its layup has no plies");
    for (const Ply& ply : part.layup)
      if (!(ply.thickness > 0.0) || !std::isfinite(ply.thickness) || !std::isfinite(ply.angle) ||
          ply.material < 0 || static_cast<std::size_t>(ply.material) >= materials.size())
        fail(part, kind, "a ply has no material, no thickness, or an angle that is not finite");
  }

  // ---- what the contour is divided into ---------------------------------------------------------

  double place(const ContourPlace& at, const auto& part, std::string_view kind) const {
    if (at.point) {
      if (*at.point < 1 || *at.point > contour_.points())
        fail(part, kind,
             fmt::format("there is no point {}, the contour has {}", *at.point, contour_.points()));
      return contour_.at_point(*at.point);
    }
    if (!(at.fraction >= 0.0 && at.fraction <= 1.0))
      fail(part, kind,
           fmt::format("{} is not a fraction of the contour, from 0 to 1", at.fraction));
    double u = contour_.at_fraction(at.fraction);
    // What is written with some digits means the corner.
    for (const double corner : contour_.corners())
      for (const double turn : {0.0, contour_.period()})
        if (std::abs(u - corner - turn) < 1e-6 * contour_.period()) u = corner;
    return u >= contour_.period() - near_ ? 0.0 : u;
  }

  // How far from u on to v, counter-clockwise, in [0, period).
  double onward(double u, double v) const {
    const double p = contour_.period(), d = v - u - p * std::floor((v - u) / p);
    return d > p - near_ ? 0.0 : d;
  }

  struct Range {
    double from, length;
    int sector;
    double to() const { return from + length; }
  };

  static bool is_whole(const AirfoilSector& s) {
    return !s.from.point && !s.to.point && s.from.fraction == 0.0 && s.to.fraction == 1.0;
  }

  // Sectors one after the other all round.
  void cover() {
    if (stated_.sectors.empty())
      throw Error("it has no sectors; give a <sector> or more, with their plies");
    for (std::size_t i = 0; i < stated_.sectors.size(); ++i) {
      const AirfoilSector& s = sector(i);
      double from = place(s.from, s, "sector"), to = place(s.to, s, "sector");
      if (contour_.reversed()) std::swap(from, to);
      const double length = is_whole(s) ? contour_.period() : onward(from, to);
      if (!(length > near_))
        fail(s, "sector", "it begins and ends at one place; its length must not be zero");
      ranges_.push_back({from, length, static_cast<int>(i)});
    }
    std::ranges::sort(ranges_, {}, &Range::from);
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      const Range& a = ranges_[i];
      const bool last = i + 1 == ranges_.size();
      const Range& b = ranges_[last ? 0 : i + 1];
      const double next = b.from + (last ? contour_.period() : 0.0);
      const auto [first, second] = std::minmax({a.sector, b.sector});
      if (a.to() > next + near_)
        fail(sector(second), "sector",
             fmt::format("it overlaps {}, both have the fraction {:.6g} of the contour; let one "
                         "begin where the other ends",
                         sector_name(first), fraction_of(next + 0.5 * (a.to() - next))));
      if (a.to() < next - near_) {
        double x = fraction_of(a.to()), y = fraction_of(next);
        if (contour_.reversed()) std::swap(x, y);
        if (y == 0.0) y = 1.0;
        fail(sector(a.sector), "sector",
             fmt::format("there is a hole beside it: no sector has the fractions from {:.6g} to "
                         "{:.6g} of the contour; give one, bare=\"on\" if there is no wall",
                         x, y));
      }
    }
    if (std::ranges::all_of(stated_.sectors, &AirfoilSector::bare))
      throw Error("all its sectors are bare; one or more must have plies");
  }

  double fraction_of(double u) const { return contour_.fraction_at(u); }

  int sector_at(double u) const {
    for (const Range& r : ranges_) {
      const double d =
          u - r.from - contour_.period() * std::floor((u - r.from) / contour_.period());
      if (d <= r.length) return r.sector;
    }
    return ranges_.back().sector;
  }

  bool bare(int s) const { return sector(s).bare; }
  double thickness(int s) const { return thickness_of(sector(s).layup); }

  void find_levels() {
    std::vector<double> all{0.0};
    for (const AirfoilSector& s : stated_.sectors) {
      double depth = 0.0;
      if (s.bare) continue;
      for (std::size_t i = s.layup.size(); i-- > 0;) all.push_back(depth += s.layup[i].thickness);
    }
    std::ranges::sort(all);
    for (const double d : all)
      if (levels_.empty() || d - levels_.back() > near_) levels_.push_back(d);
    thinnest_ = contour_.period();
    for (std::size_t i = 0; i + 1 < levels_.size(); ++i)
      thinnest_ = std::min(thinnest_, levels_[i + 1] - levels_[i]);
    for (const AirfoilWeb& web : stated_.webs)
      for (const Ply& ply : web.layup) thinnest_ = std::min(thinnest_, ply.thickness);
    plies_.resize(stated_.sectors.size());
    for (std::size_t s = 0; s < plies_.size(); ++s) {
      double depth = 0.0;
      const Layup& layup = sector(s).layup;
      for (std::size_t i = layup.size(); i-- > 0; depth += layup[i].thickness)
        plies_[s].push_back({depth, depth + layup[i].thickness, layup[i].material, layup[i].angle,
                             static_cast<int>(i + 1)});
    }
  }

  std::size_t cells_of(int s) const {
    if (bare(s)) return 0;
    return static_cast<std::size_t>(std::ranges::upper_bound(levels_, thickness(s) + near_) -
                                    levels_.begin() - 1);
  }
  double inner_of(int s) const { return levels_[cells_of(s)]; }
  const WallPly* ply(int s, std::ptrdiff_t cell) const {
    if (cell < 0 || static_cast<std::size_t>(cell) >= cells_of(s)) return nullptr;
    const auto i = static_cast<std::size_t>(cell);
    const double middle = 0.5 * (levels_[i] + levels_[i + 1]);
    for (const WallPly& p : plies_[static_cast<std::size_t>(s)])
      if (middle < p.inner) return &p;
    return &plies_[static_cast<std::size_t>(s)].back();
  }
  static bool alike(const WallPly* a, const WallPly* b) {
    if (a == nullptr || b == nullptr) return a == b;
    return a->material == b->material && a->angle == b->angle;
  }

  // ---- webs -------------------------------------------------------------------------------------

  void stand(std::size_t w) {
    const AirfoilWeb& stated = stated_.webs[w];
    const double from = place(stated.from, stated, "web"), to = place(stated.to, stated, "web");
    Web web;
    const Contour::Place a = contour_.place_of(from), b = contour_.place_of(to);
    web.from = contour_.at(a.piece, a.u).x;
    web.to = contour_.at(b.piece, b.u).x;
    const Point along = web.to - web.from;
    if (!(along.norm() > near_)) fail(stated, "web", "it begins and ends at one place");
    web.normal = Point(along(1), -along(0)) / along.norm();
    draw_lines(stated.layup, web);
    web.feet = {foot(stated, web, from), foot(stated, web, to)};
    for (std::size_t other = 0; other < w; ++other) {
      const Web& o = webs_[other];
      const Point d = web.to - web.from, e = o.to - o.from, f = o.from - web.from;
      const double det = cross(d, e), p = cross(f, e) / det, q = cross(f, d) / det;
      if (p > 0.0 && p < 1.0 && q > 0.0 && q < 1.0)
        fail(stated, "web",
             fmt::format("it crosses {}, {}; webs may not cross", web_name(other),
                         near_text(web.from + p * d)));
    }
    webs_.push_back(std::move(web));
  }

  // Plies that are much thicker than others have lines that follow what dies out next to those.
  void draw_lines(const Layup& layup, Web& web) const {
    double at = -0.5 * thickness_of(layup);
    web.across = {at};
    web.interface = {true};
    const double start = std::min(2.0 * thinnest_, start_of(thickness_of(layup), layup));
    for (std::size_t i = 0; i < layup.size(); ++i) {
      const double thick = layup[i].thickness;
      const std::vector<double> lines = spaced(0.0, thick, [&](double x) {
        return std::max(0.1 * thick, start) + 1.5 * std::min(x, thick - x);
      });
      for (std::size_t k = 1; k < lines.size(); ++k) {
        web.across.push_back(at + lines[k]);
        web.ply.push_back(i);
        web.interface.push_back(k + 1 == lines.size());
      }
      at += thick;
    }
  }

  // Of two sectors a web stands on the thicker one, else on the one that is listed first: beside the thinner one there would
  // be no room for the plies of the other.
  bool carries(int s, int other) const {
    if (bare(s)) return false;
    if (other < 0 || thickness(s) > thickness(other) + near_) return true;
    return thickness(s) > thickness(other) - near_ && s < other;
  }

  Foot foot(const AirfoilWeb& stated, const Web& web, double u) const {
    int on = -1;
    for (const int side : {1, -1}) {
      const int s = sector_at(u + side * 2.0 * near_ + contour_.period());
      if (carries(s, on)) on = s;
    }
    if (on < 0)
      fail(stated, "web",
           fmt::format("it ends at the fraction {:.6g} of the contour, where there is no wall; let "
                       "it end in a sector that is not bare",
                       fraction_of(u)));
    Foot found = foot_on(stated, web, u, on);
    for (const Range& r : ranges_)
      if (carries(r.sector, on) && (onward(found.low, r.from) < found.high - found.low ||
                                    onward(found.low, r.to()) < found.high - found.low))
        on = r.sector;
    return on == found.sector ? found : foot_on(stated, web, u, on);
  }

  Foot foot_on(const AirfoilWeb& stated, const Web& web, double u, int on) const {
    const Contour::Place begin = contour_.place_of(u);
    const Contour::Piece& piece = contour_.pieces()[static_cast<std::size_t>(begin.piece)];
    const double depth = inner_of(on);
    const Point start = contour_.at(begin.piece, begin.u).x;
    Foot foot{on, begin.piece, {}, 0.0, 0.0};
    const std::string where = fmt::format("at the fraction {:.6g} of the contour", fraction_of(u));
    for (const double w : web.across) {
      double at = begin.u;
      bool met = false;
      for (int k = 0; k < 50 && !met; ++k) {
        const Contour::At here = contour_.at(begin.piece, at);
        const double slope = here.tangent.dot(web.normal);
        if (std::abs(slope) < steepest_sine)
          fail(stated, "web",
               fmt::format("{} it meets the wall at less than 15 degrees; let it end elsewhere",
                           where));
        const double off = (here.x - depth * here.normal - start).dot(web.normal) - w;
        at -= off / (slope * here.speed * std::max(0.1, 1.0 - here.curvature * depth));
        met = std::abs(off) < 1e-14 * contour_.period();
        if (!piece.closed && (at < piece.u.front() - near_ || at > piece.u.back() + near_)) break;
      }
      if (!met || (!piece.closed && (at < piece.u.front() + near_ || at > piece.u.back() - near_)))
        fail(stated, "web",
             fmt::format("{} its foot, {:g} thick, would stand on a corner of the contour; let it "
                         "end farther from that",
                         where, thickness_of(stated.layup)));
      foot.u.push_back(at);
    }
    const auto [low, high] = std::ranges::minmax(foot.u);
    foot.low = low;
    foot.high = high;
    return foot;
  }

  void check_feet() const {
    struct Stands {
      double from, length;
      std::size_t web;
    };
    std::vector<Stands> all;
    for (std::size_t w = 0; w < webs_.size(); ++w)
      for (const Foot& f : webs_[w].feet) all.push_back({onward(0.0, f.low), f.high - f.low, w});
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = i + 1; j < all.size(); ++j)
        if (onward(all[i].from, all[j].from) <= all[i].length + near_ ||
            onward(all[j].from, all[i].from) <= all[j].length + near_) {
          const std::size_t w = all[j].web;
          fail(stated_.webs[w], "web",
               w == all[i].web
                   ? std::string("its two feet lie upon each other; let it end farther apart")
                   : fmt::format("its foot lies on that of {}, at the fraction {:.6g} of the "
                                 "contour; let them end farther apart",
                                 web_name(all[i].web), fraction_of(all[j].from)));
        }
  }

  // Where a border lies under a foot, the sector that the web stands on reaches to its far edge.
  void move_borders() {
    if (ranges_.size() < 2) return;
    const std::vector<Range> before = ranges_;
    for (std::size_t w = 0; w < webs_.size(); ++w)
      for (const Foot& f : webs_[w].feet) {
        int under = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
          const double width = f.high - f.low, at = onward(f.low - near_, before[i].from);
          if (at > width + 2.0 * near_) continue;
          if (++under > 1)
            fail(stated_.webs[w], "web",
                 fmt::format("{} is shorter than its foot, which stands on it; make that longer",
                             sector_name(before[i].sector)));
          Range &right = ranges_[i], &left = ranges_[(i + before.size() - 1) % before.size()];
          const double moved =
              right.from + (left.sector == f.sector ? width - (at - near_) : near_ - at);
          right.length -= moved - right.from;
          left.length += moved - right.from;
          right.from = moved;
        }
      }
    for (const Range& r : ranges_)
      if (!(r.length > near_)) fail(sector(r.sector), "sector", "a web covers all of it");
  }

  // ---- walls ------------------------------------------------------------------------------------

  void break_up() {
    std::vector<double> breaks = contour_.corners();
    if (ranges_.size() > 1 || breaks.empty())
      for (const Range& r : ranges_) breaks.push_back(onward(0.0, r.from));
    for (const Web& web : webs_)
      for (const Foot& f : web.feet)
        for (const double u : f.u) breaks.push_back(onward(0.0, u));
    std::ranges::sort(breaks);
    std::vector<double> distinct;
    for (const double u : breaks)
      if (distinct.empty() || u - distinct.back() > 10.0 * near_) distinct.push_back(u);
    for (std::size_t i = 0; i < distinct.size(); ++i) {
      const double from = distinct[i],
                   to = i + 1 < distinct.size() ? distinct[i + 1] : distinct[0] + contour_.period();
      const Contour::Place middle = contour_.place_of(0.5 * (from + to));
      Wall wall;
      wall.piece = middle.piece;
      wall.from = middle.u - 0.5 * (to - from);
      wall.to = middle.u + 0.5 * (to - from);
      wall.sector = sector_at(0.5 * (from + to));
      for (const Web& web : webs_)
        for (const Foot& f : web.feet)
          wall.foot = wall.foot || onward(f.low, 0.5 * (from + to)) < f.high - f.low;
      walls_.push_back(wall);
    }
    for (std::size_t i = 0; i < walls_.size(); ++i) {
      Wall &a = walls_[i], &b = walls_[(i + 1) % walls_.size()];
      const Contour::Piece& p = contour_.pieces()[static_cast<std::size_t>(a.piece)];
      if (p.closed || std::abs(a.to - p.u.back()) > 20.0 * near_) continue;
      a.to = p.u.back();
      b.from = contour_.pieces()[static_cast<std::size_t>(b.piece)].u.front();
      if (bare(a.sector) || bare(b.sector)) continue;
      const bool outward =
          cross(contour_.at(a.piece, a.to).tangent, contour_.at(b.piece, b.from).tangent) > 0.0;
      const bool butt = stated_.corners == Corners::butt && outward;
      // The one that is listed first; of one sector, the wall before the corner as points are listed.
      const bool a_through = a.sector == b.sector ? !contour_.reversed() : a.sector < b.sector;
      a.end = !butt ? End::mitred : a_through ? End::through : End::standing;
      b.begin = !butt ? End::mitred : a_through ? End::standing : End::through;
    }
  }

  const Wall& after(const Wall& wall) const {
    const auto i = static_cast<std::size_t>(&wall - walls_.data());
    return walls_[(i + 1) % walls_.size()];
  }
  const Wall& before(const Wall& wall) const {
    const auto i = static_cast<std::size_t>(&wall - walls_.data());
    return walls_[(i + walls_.size() - 1) % walls_.size()];
  }

  // (2), of the wall before a corner and that after it.
  std::array<double, 2> meet(const Wall& first, const Wall& second, double d1, double d2) const {
    double u = first.to, v = second.from;
    for (int k = 0; k < 60; ++k) {
      const Contour::At a = contour_.at(first.piece, u), b = contour_.at(second.piece, v);
      const Point off = a.x - d1 * a.normal - b.x + d2 * b.normal;
      Eigen::Matrix2d j;
      j.col(0) = a.speed * (1.0 - a.curvature * d1) * a.tangent;
      j.col(1) = -b.speed * (1.0 - b.curvature * d2) * b.tangent;
      const Eigen::Vector2d step = j.inverse() * Eigen::Vector2d(off);
      if (!step.allFinite()) break;
      u -= step(0);
      v -= step(1);
      if (step.norm() < 1e-14 * contour_.period()) return {u, v};
      if (k > 20 && step.norm() < 1e-12 * contour_.period()) return {u, v};
    }
    fail(sector(first.sector), "sector",
         fmt::format("its plies do not fit into the corner {}: at the depth {:g} they do not meet "
                     "those of the other side; make them thinner",
                     near_text(contour_.at(first.piece, first.to).x), std::max(d1, d2)));
  }

  // Where a wall ends at a depth below the contour.
  double end_at(const Wall& wall, bool is_end, double depth) const {
    const End kind = is_end ? wall.end : wall.begin;
    if (kind == End::plain) return is_end ? wall.to : wall.from;
    const Wall& other = is_end ? after(wall) : before(wall);
    const double theirs = kind == End::mitred ? depth : inner_of(other.sector);
    return is_end ? meet(wall, other, depth, theirs)[0] : meet(other, wall, theirs, depth)[1];
  }

  double u_at(const Wall& wall, double part, double depth) const {
    if (part > 0.0 && part < 1.0 && !wall.leaning) return (1.0 - part) * wall.from + part * wall.to;
    return part == 0.0 ? end_at(wall, false, depth)
           : part == 1.0
               ? end_at(wall, true, depth)
               : (1.0 - part) * end_at(wall, false, depth) + part * end_at(wall, true, depth);
  }

  void check_radii() {
    for (Wall& wall : walls_) {
      if (bare(wall.sector)) continue;
      const double depth = inner_of(wall.sector);
      constexpr int samples = 100;
      for (int i = 0; i <= samples; ++i) {
        const double u = wall.from + (wall.to - wall.from) * i / samples;
        const Contour::At at = contour_.at(wall.piece, u);
        if (at.curvature * depth > 0.999)
          fail(sector(wall.sector), "sector",
               fmt::format("its plies are {:g} thick together and do not fit: the radius of the "
                           "contour is {:.4g} {}; make them thinner there",
                           thickness(wall.sector), 1.0 / at.curvature, near_text(at.x)));
      }
      // Blunt butt corners take more from the outer surface.
      const double from = std::max(end_at(wall, false, depth), end_at(wall, false, 0.0)),
                   to = std::min(end_at(wall, true, depth), end_at(wall, true, 0.0));
      wall.cut_from = std::max(0.0, from - wall.from);
      wall.cut_to = std::max(0.0, wall.to - to);
      wall.leaning = wall.to - wall.from < 2.5 * (wall.cut_from + wall.cut_to);
      if (!(to - from > near_))
        fail(sector(wall.sector), "sector",
             fmt::format("its plies are {:g} thick together and do not fit between the corners, "
                         "borders or webs {}, which are {:.4g} apart; make them thinner there",
                         thickness(wall.sector), near_text(contour_.at(wall.piece, wall.from).x),
                         wall.to - wall.from));
    }
  }

  // Where stresses may be singular.
  void mark() {
    for (Wall& a : walls_) {
      Wall& b = walls_[static_cast<std::size_t>(&after(a) - walls_.data())];
      const bool corner = a.end != End::plain;
      for (std::size_t level = 0; level < levels_.size(); ++level) {
        const auto i = static_cast<std::ptrdiff_t>(level);
        const WallPly *a_out = ply(a.sector, i - 1), *a_in = ply(a.sector, i),
                      *b_out = ply(b.sector, i - 1), *b_in = ply(b.sector, i);
        bool is = corner || !alike(a_out, b_out) || !alike(a_in, b_in);
        if (bare(a.sector) || bare(b.sector))  // a free end: where two plies meet
          is = (a_out && a_in && !alike(a_out, a_in)) || (b_out && b_in && !alike(b_out, b_in));
        const auto side = [&](End kind, int s) {
          return kind == End::through ? level == cells_of(s) : is;
        };
        a.marked_to.push_back(side(a.end, a.sector));
        b.marked_from.push_back(side(b.begin, b.sector));
      }
    }
    for (const Web& web : webs_)
      for (const Foot& f : web.feet)
        for (std::size_t line = 0; line < f.u.size(); ++line)
          for (Wall& wall : walls_) {
            if (!web.interface[line]) continue;
            const double u = f.u[line];
            if (wall.piece != f.piece || bare(wall.sector)) continue;
            const double p = contour_.period(), wrap = p * std::round((u - wall.from) / p);
            const double wrap_to = p * std::round((u - wall.to) / p);
            const std::size_t level = cells_of(f.sector);
            if (std::abs(u - wall.from - wrap) < 20.0 * near_) wall.marked_from[level] = true;
            if (std::abs(u - wall.to - wrap_to) < 20.0 * near_) wall.marked_to[level] = true;
          }
  }

  // ---- cells ------------------------------------------------------------------------------------

  int most_rings() const {
    const double least = 1e-11 * contour_.period() / (0.04 * thinnest_ / 3.0);
    return std::max(1, static_cast<int>(std::log(least) / std::log(ring_ratio)));
  }

  double longest() const { return std::max(50.0 * thinnest_, contour_.period() / 128.0); }

  // Length of the elements where a wall ends: what plies do to each other there dies out over lengths from their thickness to
  // that of the wall.
  static double start_of(double thick, const Layup& layup) {
    const double least = std::ranges::min_element(layup, {}, &Ply::thickness)->thickness;
    return std::clamp(2.0 * least, 0.1 * thick, thick);
  }

  // Where the elements along a wall end, as parts of it. One that ends at a corner is so long that its inner side is half of
  // its outer one.
  std::vector<double> parts_of(const Wall& wall, int layers) const {
    if (wall.foot) return {0.0, 1.0};
    const double thick = inner_of(wall.sector), length = wall.to - wall.from,
                 start = start_of(thick, sector(wall.sector).layup);
    const auto has = [](const std::vector<bool>& marks) { return std::ranges::count(marks, true); };
    const double cut_from = wall.leaning ? 0.0 : 2.0 * wall.cut_from,
                 cut_to = wall.leaning ? 0.0 : 2.0 * wall.cut_to;
    const bool is_fine_from = has(wall.marked_from) > 0 || bare(before(wall).sector),
               is_fine_to = has(wall.marked_to) > 0 || bare(after(wall).sector);
    const double fine_from = is_fine_from ? std::max(start, cut_from) : length,
                 fine_to = is_fine_to ? std::max(start, cut_to) : length;
    const auto size = [&](double u) {
      const double bend = std::abs(contour_.at(wall.piece, u).curvature);
      return std::min({longest(), bend > 0.0 ? 0.6 / bend : length,
                       fine_from + 1.5 * (u - wall.from), fine_to + 1.5 * (wall.to - u)});
    };
    std::vector<double> ends{wall.from};
    if (cut_from > 0.0) ends.push_back(wall.from + cut_from);
    const double first = ends.back(), last = wall.to - cut_to;
    for (const double u : knots(wall, 1e-3 * thick * std::pow(0.2, layers - 1)))
      if (u - first > 0.3 * size(first) && last - u > 0.3 * size(last)) ends.push_back(u);
    if (cut_to > 0.0) ends.push_back(last);
    ends.push_back(wall.to);
    std::vector<double> parts{0.0};
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const bool is_end = i + 2 == ends.size(),
                 whole = (i == 0 && cut_from > 0.0) || (is_end && cut_to > 0.0);
      const std::vector<double> some =
          whole ? std::vector<double>{ends[i], ends[i + 1]} : spaced(ends[i], ends[i + 1], size);
      for (std::size_t k = 1; k < some.size(); ++k)
        parts.push_back(is_end && k + 1 == some.size() ? 1.0 : (some[k] - wall.from) / length);
    }
    return parts;
  }

  // Points of the contour at which an element that ran across them would miss it by more than `most`.
  std::vector<double> knots(const Wall& wall, double most) const {
    const Contour::Piece& p = contour_.pieces()[static_cast<std::size_t>(wall.piece)];
    const std::size_t n = p.u.size();
    std::vector<std::pair<double, double>> inside;  // u, and the jump of the third derivative there
    const auto third = [&](std::size_t i) -> Point {
      return (p.second[i + 1] - p.second[i]) / (p.u[i + 1] - p.u[i]);
    };
    for (std::size_t i = p.closed ? 0 : 1; i + 1 < n; ++i) {
      const double jump = (third(i) - third(i == 0 ? n - 2 : i - 1)).norm();
      for (const double turn : {-contour_.period(), 0.0, contour_.period()}) {
        const double u = p.u[i] + (p.closed ? turn : 0.0);
        if (u > wall.from + near_ && u < wall.to - near_ && (p.closed || turn == 0.0))
          inside.emplace_back(u, jump);
      }
    }
    std::ranges::sort(inside);
    std::vector<double> kept;
    double last = wall.from, largest = 0.0;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const double next = i + 1 < inside.size() ? inside[i + 1].first : wall.to;
      largest = std::max(largest, inside[i].second);
      if (largest * std::pow(next - last, 3) / 48.0 <= most) continue;
      kept.push_back(inside[i].first);
      last = inside[i].first;
      largest = 0.0;
    }
    return kept;
  }

  std::vector<Cell> cells(int layers) const {
    std::vector<Cell> all;
    for (const Wall& wall : walls_)
      if (!bare(wall.sector)) add_wall(wall, parts_of(wall, layers), all);
    for (const Wall& wall : walls_) {
      if (wall.end == End::through) add_corner(wall, after(wall), true, all);
      if (wall.end == End::standing) add_corner(wall, after(wall), false, all);
    }
    for (std::size_t w = 0; w < webs_.size(); ++w) add_web(w, all);
    return all;
  }

  Cell cell_of(const WallPly& p, int s) const {
    Cell cell;
    cell.material = p.material;
    cell.angle = p.angle;
    cell.part = s;
    cell.name = fmt::format("ply {} of {}", p.number, sector_name(s));
    return cell;
  }

  // The normal at u of a piece, without jumps about that at `middle`.
  double normal_at(int piece, double u, const Point& middle) const {
    const Point n = contour_.at(piece, u).normal;
    return std::atan2(middle(1), middle(0)) + std::atan2(cross(middle, n), middle.dot(n));
  }

  void add_wall(const Wall& wall, const std::vector<double>& parts, std::vector<Cell>& all) const {
    const auto count = static_cast<std::ptrdiff_t>(cells_of(wall.sector));
    for (std::size_t k = 0; k + 1 < parts.size(); ++k)
      for (std::ptrdiff_t i = 0; i < count; ++i) {
        const auto level = static_cast<std::size_t>(i);
        Cell cell = cell_of(*ply(wall.sector, i), wall.sector);
        const double a = parts[k], b = parts[k + 1], c = levels_[level], d = levels_[level + 1];
        const auto depth = [c, d](double eta) { return (1 - eta) * c + eta * d; };
        const auto u = [this, &wall, a, b, depth](double xi, double eta) {
          return (1 - xi) * u_at(wall, a, depth(eta)) + xi * u_at(wall, b, depth(eta));
        };
        const Point middle = contour_.at(wall.piece, u(0.5, 0.0)).normal;
        cell.map = [this, &wall, u, depth](double xi, double eta) {
          return contour_.inside(wall.piece, u(xi, eta), depth(eta));
        };
        cell.normal = [this, &wall, u, middle](double xi, double eta) {
          return normal_at(wall.piece, u(xi, eta), middle);
        };
        const bool first = k == 0, last = k + 2 == parts.size();
        cell.marked = {first && wall.marked_from[level], last && wall.marked_to[level],
                       last && wall.marked_to[level + 1], first && wall.marked_from[level + 1]};
        all.push_back(std::move(cell));
      }
  }

  // What the wall that goes through has in a butt corner, over the plies of the other one.
  void add_corner(const Wall& a, const Wall& b, bool first_through, std::vector<Cell>& all) const {
    const Wall &through = first_through ? a : b, &standing = first_through ? b : a;
    const std::size_t rows = cells_of(through.sector), columns = cells_of(standing.sector);
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t i = 0; i < rows; ++i) {
        Cell cell = cell_of(*ply(through.sector, static_cast<std::ptrdiff_t>(i)), through.sector);
        const std::array<double, 2> own{levels_[i], levels_[i + 1]};
        std::array<double, 2> other{levels_[j], levels_[j + 1]};
        if (first_through) std::swap(other[0], other[1]);  // along the contour
        const auto u = [this, &a, &b, own, other, first_through](double xi, double eta) {
          const double d = (1 - eta) * own[0] + eta * own[1],
                       e = (1 - xi) * other[0] + xi * other[1];
          return std::pair(first_through ? meet(a, b, d, e)[0] : meet(a, b, e, d)[1], d);
        };
        const Point middle = contour_.at(through.piece, u(0.5, 0.0).first).normal;
        cell.map = [this, &through, u](double xi, double eta) {
          const auto [at, depth] = u(xi, eta);
          return contour_.inside(through.piece, at, depth);
        };
        cell.normal = [this, &through, u, middle](double xi, double eta) {
          return normal_at(through.piece, u(xi, eta).first, middle);
        };
        const bool inner = i + 1 == rows;  // upon which the other one stands
        cell.marked = {false, false, inner, inner};
        all.push_back(std::move(cell));
      }
  }

  void add_web(std::size_t w, std::vector<Cell>& all) const {
    const Web& web = webs_[w];
    const Layup& layup = stated_.webs[w].layup;
    const double length = (web.to - web.from).norm(), thick = thickness_of(layup);
    std::vector<double> parts = spaced(0.0, length, [&](double x) {
      return std::min(longest(), start_of(thick, layup) + 1.5 * std::min(x, length - x));
    });
    for (double& x : parts) x /= length;
    parts.back() = 1.0;
    const double normal = std::atan2(web.normal(1), web.normal(0));
    for (std::size_t j = 0; j < web.ply.size(); ++j)
      for (std::size_t k = 0; k + 1 < parts.size(); ++k) {
        Cell cell;
        const std::size_t ply = web.ply[j];
        cell.material = layup[ply].material;
        cell.angle = layup[ply].angle;
        cell.part = static_cast<int>(stated_.sectors.size() + w);
        cell.name = fmt::format("ply {} of {}", ply + 1, web_name(w));
        const double a = parts[k], b = parts[k + 1];
        cell.map = [this, &web, j, a, b](double xi, double eta) {
          const double part = (1 - eta) * a + eta * b;
          return Point((1 - part) * on_foot(web.feet[0], j, xi) +
                       part * on_foot(web.feet[1], j, xi));
        };
        cell.normal = [normal](double, double) { return normal; };
        const bool first = k == 0, last = k + 2 == parts.size();
        const bool left = web.interface[j], right = web.interface[j + 1];
        cell.marked = {first && left, first && right, last && right, last && left};
        all.push_back(std::move(cell));
      }
  }

  Point on_foot(const Foot& foot, std::size_t j, double xi) const {
    return contour_.inside(foot.piece, (1 - xi) * foot.u[j] + xi * foot.u[j + 1],
                           inner_of(foot.sector));
  }

  // ---- what a mesh of them must be ----------------------------------------------------------------

  [[noreturn]] void fail_part(int part, const std::string& what) const {
    const auto i = static_cast<std::size_t>(part);
    if (i < stated_.sectors.size()) fail(sector(i), "sector", what);
    fail(stated_.webs[i - stated_.sectors.size()], "web", what);
  }

  void check(const std::vector<Cell>& all) const {
    for (const Cell& cell : all) check_area(cell);
    struct Side {
      std::size_t cell;
      std::array<Point, 5> x;
      int count;
    };
    std::vector<Point> middles;
    Places places(middles, near_);
    std::vector<Side> sides;
    DisjointSets joined(static_cast<int>(all.size()));
    for (std::size_t c = 0; c < all.size(); ++c)
      for (int side = 0; side < 4; ++side) {
        Side made{c, {}, 1};
        for (int k = 0; k < 5; ++k) {
          const double t = 0.25 * k;
          made.x[static_cast<std::size_t>(k)] = side == 0   ? all[c].map(t, 0)
                                                : side == 1 ? all[c].map(1, t)
                                                : side == 2 ? all[c].map(1 - t, 1)
                                                            : all[c].map(0, 1 - t);
        }
        const auto at = static_cast<std::size_t>(places.at(made.x[2]));
        if (at < sides.size()) {
          ++sides[at].count;
          joined.join(static_cast<int>(c), static_cast<int>(sides[at].cell));
        } else {
          sides.push_back(made);
        }
      }
    for (std::size_t c = 1; c < all.size(); ++c)
      if (joined.root(static_cast<int>(c)) != joined.root(0))
        fail_part(all[c].part,
                  fmt::format("it is joined neither by other sectors nor by webs to {}; a section "
                              "must be in one piece",
                              all[0].name));
    std::vector<Chord> chords;
    for (const Side& side : sides)
      if (side.count == 1)
        for (std::size_t k = 0; k < 4; ++k)
          chords.push_back({side.x[k], side.x[k + 1], static_cast<int>(side.cell)});
    check_crossings(all, chords);
  }

  void check_area(const Cell& cell) const {
    constexpr int n = 4;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double a = 1.0 * i / n, b = 1.0 * (i + 1) / n, c = 1.0 * j / n, d = 1.0 * (j + 1) / n;
        const Point x = cell.map(a, c), p = cell.map(b, c) - x, q = cell.map(b, d) - x,
                    r = cell.map(a, d) - x;
        if (!(cross(p, q) > 0.0) || !(cross(q, r) > 0.0))
          fail_part(cell.part, fmt::format("{} is folded {}: the plies are too thick to fit there; "
                                           "make them thinner, or leave more room",
                                           cell.name, near_text(x)));
      }
  }

  void check_crossings(const std::vector<Cell>& all, const std::vector<Chord>& chords) const {
    const auto neighbours = [&](std::size_t a, std::size_t b) {
      for (const Point& p : {chords[a].from, chords[a].to})
        for (const Point& q : {chords[b].from, chords[b].to})
          if ((p - q).norm() < near_) return true;
      return false;
    };
    if (const auto found = first_crossing(chords, neighbours)) {
      const Cell &a = all[static_cast<std::size_t>(chords[found->first].of)],
                 &b = all[static_cast<std::size_t>(chords[found->second].of)];
      fail_part(std::max(a.part, b.part),
                fmt::format("{} and {} run into each other {}: together they are thicker than what "
                            "is between them; make them thinner, or let walls and webs leave each "
                            "other room",
                            a.name, b.name, near_text(chords[found->first].from)));
    }
  }

  Airfoil stated_;
  Contour contour_;
  double near_ = 0.0, thinnest_ = 0.0;
  std::vector<Range> ranges_;
  std::vector<double> levels_;  // depths of all interfaces, from 0 on
  std::vector<std::vector<WallPly>> plies_;
  std::vector<Web> webs_;
  std::vector<Wall> walls_;
};

}  // namespace

Mesher airfoil(const Airfoil& stated, const std::vector<MeshMaterial>& materials) {
  const auto walls = std::make_shared<const Walls>(stated, materials);
  return [walls, materials](const Fineness& fineness) { return walls->mesh(fineness, materials); };
}

}  // namespace mbd::section
