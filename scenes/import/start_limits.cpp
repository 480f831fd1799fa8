#include "scenes/import/start_limits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "core/base/union_find.h"
#include "core/math/dense.h"
#include "core/math/so3.h"

namespace taut::model {
namespace {

struct StartTuning {
  /// What an axis may be beyond its limits [rad or m]; loops are as closed as that afterwards.
  static constexpr double kBeyond = 1e-9, kClosed = 1e-12, kNearlyClosed = 1e-6;
  /// Axes go to their limits in parts of at most this [rad or m], but at most so many, and loops follow:
  /// after longer ones a loop may close in another of the forms that it has.
  static constexpr double kPart = 0.05;
  static constexpr int kMostParts = 40;
  /// Limits that are further away than this [rad or m] are none that anyone meant.
  static constexpr double kFarthest = 1e4;
  /// Newton steps of a part, none of which changes a value by more than the second [rad or m].
  static constexpr int kMostSteps = 60;
  static constexpr double kLongestStep = 0.3;
  /// Singular values below this part of the largest are 0: loops of planar mechanisms have rows too many.
  static constexpr double kNoSingularValue = 1e-7;
  /// Values that are sought at once.
  static constexpr std::size_t kMostValues = 100;
};

/// The displacement along an axis by its value, that of a ball by its rotation vector, in the frame of the
/// link as it starts.
Pose displacement(const LinkAxis& axis, const Vec3& value) {
  if (axis.kind == LinkAxis::Kind::kSlide) return {Quat::Identity(), value[0] * axis.axis};
  const Quat q = exp_so3(axis.kind == LinkAxis::Kind::kBall ? value : Vec3(value[0] * axis.axis));
  Vec3 p = axis.anchor - q * axis.anchor;
  if (axis.kind == LinkAxis::Kind::kScrew) p += axis.pitch * value[0] / (2 * std::numbers::pi) * axis.axis;
  return {q, p};
}

/// All axes of a chain, the first next to the parent.
Pose displacement(const std::vector<LinkAxis>& axes, const std::vector<Vec3>& values) {
  Pose X;
  for (std::size_t k = 0; k < axes.size(); ++k) X = X * displacement(axes[k], values[k]);
  return X;
}

/// What is next to the parent stays there while the axes behind it move the link.
void displace(std::vector<LinkAxis>& axes, const std::vector<Vec3>& values) {
  Pose behind;
  for (std::size_t k = axes.size(); k-- > 0;) {
    const Pose X = inverse(behind);
    const Pose own = displacement(axes[k], values[k]);
    axes[k].anchor = X.point(axes[k].anchor);
    axes[k].axis = (X.q * axes[k].axis).normalized();
    behind = own * behind;
  }
}

class StartSearch {
 public:
  explicit StartSearch(RobotModel& model) : model_(model) {
    for (const Link& link : model_.links) values_.emplace_back(link.axes.size(), Vec3::Zero());
    for (const Loop& loop : model_.loops) values_.emplace_back(loop.axes.size(), Vec3::Zero());
  }

  void run() {
    gather();
    for (const auto& [root, part] : parts()) {
      if (!starts_beyond(part)) continue;
      settle(part, seek(part));
    }
    if (moved_) move();
  }

 private:
  /// An axis of a link, or of a loop: its place among the values.
  struct Place {
    int owner = 0, axis = 0;
    auto operator<=>(const Place&) const = default;
  };
  /// Axes that depend on each other, with what makes them.
  struct Part {
    std::vector<Place> axes;
    std::vector<const Loop*> loops;
    std::vector<const AxisRelation*> relations;
  };

  int loop_owner(std::size_t loop) const { return static_cast<int>(model_.links.size() + loop); }
  std::vector<LinkAxis>& axes_of(int owner) {
    const auto links = static_cast<int>(model_.links.size());
    return owner < links ? model_.links[owner].axes : model_.loops[owner - links].axes;
  }
  LinkAxis& axis(const Place& place) { return axes_of(place.owner)[place.axis]; }

  // --- who depends on whom
  /// By link: axes of one link are moved together.
  void gather() {
    joined_.reset(static_cast<int>(values_.size()));
    for (std::size_t i = 0; i < model_.loops.size(); ++i)
      if (model_.loops[i].active)
        for (int link : between(model_.loops[i].a.link, model_.loops[i].b.link))
          joined_.join(loop_owner(i), link);
    for (const AxisRelation& relation : model_.relations)
      for (const auto& from : {relation.driving, relation.other})
        if (relation.active && from) joined_.join(relation.driven.link, from->link);
  }
  /// What a link hangs on.
  int carrier(int link) const { return model_.links[link].free ? kWorld : model_.links[link].parent; }
  std::vector<int> way_to_the_world(int link) const {
    std::vector<int> way;
    for (; link != kWorld; link = carrier(link)) way.push_back(link);
    return way;
  }
  /// Links that move one of the two against the other.
  std::vector<int> between(int a, int b) const {
    std::vector<int> first = way_to_the_world(a), second = way_to_the_world(b);
    while (!first.empty() && !second.empty() && first.back() == second.back())
      first.pop_back(), second.pop_back();
    first.insert(first.end(), second.begin(), second.end());
    return first;
  }
  std::map<int, Part> parts() {
    std::map<int, Part> result;
    for (int owner = 0; owner < static_cast<int>(values_.size()); ++owner)
      for (int k = 0; k < static_cast<int>(values_[owner].size()); ++k)
        result[joined_.find(owner)].axes.push_back({owner, k});
    for (std::size_t i = 0; i < model_.loops.size(); ++i)
      if (model_.loops[i].active) result[joined_.find(loop_owner(i))].loops.push_back(&model_.loops[i]);
    for (const AxisRelation& relation : model_.relations)
      if (relation.active) result[joined_.find(relation.driven.link)].relations.push_back(&relation);
    return result;
  }
  bool starts_beyond(const Part& part) {
    return std::ranges::any_of(part.axes, [&](const Place& place) { return is_beyond(axis(place)); });
  }
  static bool is_beyond(const LinkAxis& axis) {
    return axis.kind != LinkAxis::Kind::kBall && (axis.start < axis.law.lower - StartTuning::kBeyond ||
                                                  axis.start > axis.law.upper + StartTuning::kBeyond);
  }

  // --- how far loops are open
  Pose pose(int link) const {
    Pose X;
    for (std::vector<int> way = way_to_the_world(link); !way.empty(); way.pop_back())
      X = pose_on(X, way.back());
    return X;
  }
  /// Where a link is on a parent that is at X_WP.
  Pose pose_on(const Pose& X_WP, int link) const {
    const Link& it = model_.links[link];
    if (it.free) return it.X_WL;
    return X_WP * inverse(start(it.parent)) * it.X_WL * displacement(it.axes, values_[link]);
  }
  /// Of all links, each once.
  std::vector<Pose> poses() const {
    std::vector<Pose> result(model_.links.size());
    std::vector<char> known(model_.links.size(), 0);
    for (int i = 0; i < static_cast<int>(result.size()); ++i) {
      std::vector<int> way;
      for (int link = i; link != kWorld && !known[link]; link = carrier(link)) way.push_back(link);
      for (; !way.empty(); way.pop_back()) {
        const int link = way.back(), parent = carrier(link);
        result[link] = pose_on(parent == kWorld ? Pose{} : result[parent], link);
        known[link] = 1;
      }
    }
    return result;
  }
  Pose start(int link) const { return link == kWorld ? Pose{} : model_.links[link].X_WL; }
  void append_gap(const Loop& loop, std::vector<double>& gap) const {
    Pose A = pose(loop.a.link) * loop.a.X_LF, B = pose(loop.b.link) * loop.b.X_LF;
    bool turned = loop.fixed;
    if (!loop.axes.empty()) {
      const auto index = static_cast<std::size_t>(&loop - model_.loops.data());
      const Pose at{Quat::Identity(), loop.axes[0].anchor};
      A = pose(loop.a.link) * inverse(start(loop.a.link)) * start(loop.b.link) *
          displacement(loop.axes, values_[loop_owner(index)]) * at;
      B = pose(loop.b.link) * at;
      turned = loop.axes[0].kind != LinkAxis::Kind::kBall;
    }
    turned = turned || loop.hinge;
    const Vec3 p = B.p - A.p, turn = loop.hinge ? Vec3(B.q * *loop.hinge - A.q * *loop.hinge)
                                     : turned   ? log_so3(A.q.conjugate() * B.q)
                                                : Vec3(Vec3::Zero());
    gap.insert(gap.end(), p.begin(), p.end());
    if (turned) gap.insert(gap.end(), turn.begin(), turn.end());
  }
  std::vector<double> gaps(const Part& part) const {
    std::vector<double> gap;
    for (const Loop* loop : part.loops) append_gap(*loop, gap);
    for (const AxisRelation* relation : part.relations) {
      const auto value = [&](const AxisName& name) { return values_[name.link][name.axis][0]; };
      gap.push_back(relation->other ? value(relation->driven) - 0.5 * value(*relation->driving) -
                                          0.5 * value(*relation->other)
                    : relation->driving
                        ? value(relation->driven) - relation->ratio * value(*relation->driving)
                        : value(relation->driven) + start_of(relation->driven) - relation->value);
    }
    return gap;
  }
  double start_of(const AxisName& name) const { return model_.links[name.link].axes[name.axis].start; }

  // --- values that close them
  struct Unknown {
    double* value;
    double lower, upper;  ///< what the limits leave of the value
    double first, last;   ///< what this part of the way leaves of it
  };
  std::vector<Unknown> unknowns_of(const Part& part) {
    std::vector<Unknown> unknowns;
    for (const Place& place : part.axes) {
      const LinkAxis& it = axis(place);
      Vec3& value = values_[place.owner][place.axis];
      if (it.kind == LinkAxis::Kind::kBall)
        for (double& component : value) unknowns.push_back({&component, -kNoLimit, kNoLimit, 0, 0});
      else
        unknowns.push_back({&value[0], it.law.lower - it.start, it.law.upper - it.start, 0, 0});
    }
    return unknowns;
  }

  /// From the start to the limits in small parts.  Why there is no such start; null: there is.
  const char* seek(const Part& part) {
    if (part.axes.size() > StartTuning::kMostValues)
      return "more than 100 axes depend on it, for which no start is sought";
    std::vector<Unknown> unknowns = unknowns_of(part);
    double farthest = 0;
    for (const Unknown& u : unknowns) farthest = std::max({farthest, u.lower, -u.upper});
    if (farthest > StartTuning::kFarthest) return "they are further away than 1e4";
    open_ = StartTuning::kNearlyClosed;
    for (const double gap : gaps(part)) open_ = std::max(open_, std::abs(gap));
    const int count = std::min(static_cast<int>(farthest / StartTuning::kPart) + 1, StartTuning::kMostParts);
    for (int i = 1; i <= count; ++i) {
      const double way = static_cast<double>(i) / count;
      for (Unknown& u : unknowns) {
        u.first = u.lower > 0 ? way * u.lower : u.lower;
        u.last = u.upper < 0 ? way * u.upper : u.upper;
      }
      if (!close(part, unknowns, i == count ? StartTuning::kClosed : StartTuning::kNearlyClosed))
        return "no start is found where loops are closed and limits kept";
    }
    return nullptr;
  }

  /// First towards the least values that close the gaps, then to what closes them exactly, or as far as axes
  /// can: what a rounded file has left open across a planar mechanism is no more afterwards, and closed when
  /// the scene is assembled.
  bool close(const Part& part, std::vector<Unknown>& unknowns, double tolerance) {
    for (const Unknown& u : unknowns) *u.value = std::clamp(*u.value, u.first, u.last);
    for (int i = 0; i < StartTuning::kMostSteps; ++i) {
      const std::vector<double> gap = gaps(part);
      const Eigen::VectorXd r = Eigen::VectorXd::Map(gap.data(), static_cast<Eigen::Index>(gap.size()));
      if (!r.allFinite()) return false;
      const bool back = 2 * i < StartTuning::kMostSteps;
      if (r.size() == 0 || (!back && r.cwiseAbs().maxCoeff() <= tolerance)) return true;
      const Eigen::MatrixXd J = jacobian(part, unknowns, r);
      if (!J.allFinite()) return false;
      const Eigen::VectorXd step = bounded_step(unknowns, J, r, back);
      const double longest = step.cwiseAbs().maxCoeff();
      if (!back && longest <= tolerance && r.cwiseAbs().maxCoeff() <= open_) return true;
      if (back && longest < StartTuning::kNearlyClosed) i = StartTuning::kMostSteps / 2;
      const double scale = longest > StartTuning::kLongestStep ? StartTuning::kLongestStep / longest : 1;
      for (std::size_t k = 0; k < unknowns.size(); ++k) {
        const Unknown& u = unknowns[k];
        *u.value = std::clamp(*u.value + scale * step[static_cast<Eigen::Index>(k)], u.first, u.last);
      }
    }
    return false;
  }

  Eigen::MatrixXd jacobian(const Part& part, const std::vector<Unknown>& unknowns,
                           const Eigen::VectorXd& r) const {
    constexpr double kDifference = 1e-7;
    Eigen::MatrixXd J(r.size(), static_cast<Eigen::Index>(unknowns.size()));
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      const double before = *unknowns[k].value;
      *unknowns[k].value = before + kDifference;
      const std::vector<double> gap = gaps(part);
      *unknowns[k].value = before;
      J.col(static_cast<Eigen::Index>(k)) = (Eigen::VectorXd::Map(gap.data(), r.size()) - r) / kDifference;
    }
    return J;
  }

  /// The step that closes the gaps to first order, J Δ = −r, without values that would pass their bounds: the
  /// least one, or the one `back` to the least values θ + Δ.
  static Eigen::VectorXd bounded_step(const std::vector<Unknown>& unknowns, Eigen::MatrixXd J,
                                      const Eigen::VectorXd& r, bool back) {
    Eigen::VectorXd home = Eigen::VectorXd::Zero(J.cols());
    for (std::size_t k = 0; back && k < unknowns.size(); ++k)
      home[static_cast<Eigen::Index>(k)] = -*unknowns[k].value;
    for (std::size_t trial = 0;; ++trial) {
      const Eigen::VectorXd step = home + least_step(J, r + dense::product(J, home).col(0));
      bool held = false;
      for (std::size_t k = 0; k < unknowns.size(); ++k) {
        const Unknown& u = unknowns[k];
        const auto column = static_cast<Eigen::Index>(k);
        if (!(step[column] < 0 && *u.value <= u.first) && !(step[column] > 0 && *u.value >= u.last)) continue;
        J.col(column).setZero();
        home[column] = 0;
        held = true;
      }
      if (!held || trial == unknowns.size()) return step;
    }
  }
  /// −J⁺ r, from J Jᵀ or Jᵀ J, whichever is smaller.
  static Eigen::VectorXd least_step(const Eigen::MatrixXd& J, const Eigen::VectorXd& r) {
    const bool wide = J.rows() <= J.cols();
    const Eigen::MatrixXd Jt = J.transpose();
    const auto [values, vectors] =
        dense::symmetric_eigenpairs(wide ? dense::product(J, Jt) : dense::product(Jt, J));
    const Eigen::VectorXd right = wide ? r : Eigen::VectorXd(Jt * r);
    const double cutoff = std::pow(StartTuning::kNoSingularValue, 2) * values.maxCoeff();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size());
    for (Eigen::Index k = 0; k < values.size(); ++k)
      if (values[k] > cutoff) x -= vectors.col(k).dot(right) / values[k] * vectors.col(k);
    return wide ? Eigen::VectorXd(Jt * x) : x;
  }

  // --- what becomes of it
  void settle(const Part& part, const char* obstacle) {
    const bool found = obstacle == nullptr;
    moved_ = moved_ || found;
    for (const Place& place : part.axes) {
      LinkAxis& it = axis(place);
      Vec3& value = values_[place.owner][place.axis];
      if (!found) value.setZero();
      if (!is_beyond(it)) continue;
      std::ostringstream message;
      message.precision(6);
      message << '"' << it.name << "\" starts at " << it.start
              << ", beyond its limits (value: " << it.law.lower << " to " << it.law.upper << "): ";
      if (found) {
        message << "it starts at " << it.start + value[0] << " now, which is 0 in the scene"
                << (part.axes.size() > 1 ? ", and axes that depend on it move along with it" : "");
      } else {
        message << obstacle << ": the limit is given up";
        (it.start < it.law.lower ? it.law.lower : it.law.upper) =
            it.start < it.law.lower ? -kNoLimit : kNoLimit;
      }
      model_.notices.push_back({it.place, message.str(), 1});
    }
  }

  void move() {
    const std::vector<Pose> moved = poses();
    for (int owner = 0; owner < static_cast<int>(values_.size()); ++owner) {
      displace(axes_of(owner), values_[owner]);
      for (std::size_t k = 0; k < values_[owner].size(); ++k) {
        LinkAxis& it = axes_of(owner)[k];
        if (it.kind == LinkAxis::Kind::kBall) continue;
        it.start = std::clamp(it.start + values_[owner][k][0], it.law.lower, it.law.upper);
      }
    }
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      model_.links[i].X_WL = moved[i];
      model_.links[i].X_WL.q.normalize();
    }
  }

  RobotModel& model_;
  std::vector<std::vector<Vec3>> values_;  // by link, and then by loop: of its axes, against the start
  UnionFind joined_;
  bool moved_ = false;
  double open_ = 0;  // how far loops of a part are open at the start, or what is nearly closed
};

}  // namespace

void start_within_limits(RobotModel& model) { StartSearch(model).run(); }

}  // namespace taut::model
