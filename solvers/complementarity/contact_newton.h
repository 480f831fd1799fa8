#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "solvers/laws/contact_laws.h"
#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"

namespace taut {

inline std::span<double> span_of(Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// When the iteration ends: the residual that is sought, and what is enough if that takes long; errors of
/// rates below `rate_tolerance` [m/s or rad/s] do not count.
struct NewtonLimits {
  double tolerance = 1e-9, most = 1e-8, rate_tolerance = 0;
  int iterations = 500;
  bool near = false;  ///< the guess is nearly right
  /// Ends where rounds no longer lower the slip of contacts that share a load: they do not hold.
  bool holding = false;
};

/// How it went.
struct NewtonOutcome {
  int iterations = 0;  ///< Newton steps: a factorisation and a back-solve each
  int rounds = 0;      ///< of the proximal iteration
  /// Natural map at the end, over the size of impulses, the largest |λ| √S_rr and |b| / √S_rr [√J].
  double residual = 0;
  bool converged = false;  ///< else λ and w are those of the best round in which joints were closed, if any
};

/// w = S λ + b with Coulomb's law in each contact and the law of each other row, through the bodies:
///
///     rounds    λ̄ ← λ = P(λ̄ − Σ⁻¹ (b + W v − t + s)),   s = μ |u_t| along the normals
///     Newton    v − Wᵀ P(λ̄ − Σ⁻¹ (b + W v − t + s)) = 0   for the velocities v = Wᵀ λ
///
/// P is the projection onto what the laws allow: Coulomb's cone, or a row's own answer.  With s, which makes
/// Coulomb's law the normality law of the cone [DeSaxce1998], held fixed in a round [Cadoux2009], Newton's
/// equation is the gradient of a strictly convex function with piecewise smooth gradient: a semismooth Newton
/// method [QiSun1993] with line search meets it from anywhere.  The rounds are the proximal point iteration
/// [Rockafellar1976], which takes away what Σ gave.  S may be singular.  Heaps and compliant contacts begin
/// with rounds that hold nothing fast and have the Σ for which they end; all else comes to them where s does
/// not settle.  (solvers/complementarity, "Many contacts")
class ContactNewton {
 public:
  explicit ContactNewton(ConstraintSystem& system) : system_(system) {}

  /// S = W Wᵀ with the W that the system has.  `lambda`: a guess, then the result; `w`: its rates.
  NewtonOutcome solve(const ContactLaws& contacts, std::span<const RowLaw> laws, std::span<const double> b,
                      std::span<double> lambda, std::span<double> w, const NewtonLimits& limits,
                      StageTimes& times);

  /// The rates w meet the equalities of joints, to some times the tolerance of rates.
  bool holds_joints(std::span<const RowLaw> laws, std::span<const double> w, double rate_tolerance) const;
  /// Contacts are all that there is, or very many: rounds that hold nothing fast come first.
  bool is_heap() const;

 private:
  /// Σ over S_rr where nothing is lagged, at first.
  static constexpr double kNearRho = 1e-4;

  /// What the iteration works on.
  struct Problem {
    const ContactLaws& contacts;
    std::span<const RowLaw> laws;
    std::span<const double> b;
    std::span<double> lambda, w;
  };

  /// What of Coulomb's law is held fast in a round: s = μ |u_t| or the radius μ Λ_n of a disc, or nothing.
  enum class Mode { kSlip, kRadius, kCoupled };

  void begin(const Problem& problem);
  void keep_best(const Problem& problem, double residual);
  void give_best(const Problem& problem, NewtonOutcome& outcome) const;
  void set_sigma(const Problem& problem, double rho);
  Mode next_mode(const Problem& problem, bool met, double residual, double& rho);
  void begin_coupled(double residual);
  bool adapt(const Problem& problem, bool met, double residual, double& rho);
  bool next_round(const Problem& problem, Mode mode);
  void read_rates(const Problem& problem) const;
  void read_gradient();
  void start_round(const Problem& problem);
  bool by_radius(const ContactLaws::Cone& cone) const;
  void read_lagged(const Problem& problem, Eigen::VectorXd& s) const;
  void answer_lagged(const Problem& problem, Eigen::VectorXd& s) const;
  void extrapolate();
  bool minimize(const Problem& problem, double tolerance, const NewtonLimits& limits, StageTimes& times,
                NewtonOutcome& outcome);
  void search(const Problem& problem);
  void coupled_step();
  void solve_coupled(double part);
  void add_coupling(double part, const Eigen::VectorXd& u, Eigen::VectorXd& sum) const;
  void project(const Problem& problem, double length = 0);
  void project_row(const RowLaw& law, int row);
  void project_contact(const Problem& problem, int place);
  void project_cone(int place, const ContactLaws::Cone& cone, double normal, const Vec2& tangent);
  void project_disc(int place, int first, const Vec2& given);
  void turn_rows(int place, double mu, int first, const Vec2& direction);
  double law_error(const Problem& problem, double rate_tolerance, int rounds) const;

  ConstraintSystem& system_;
  double scale_ = 0;
  std::vector<double> own_, sigma_, target_, shift_;          // S_rr, Σ with compliance, t, s
  std::vector<double> carry_;                                 // what part of that Σ is the round's own
  std::vector<double> last_, x_, y_, rates_, rates_of_step_;  // λ̄, x, P(x), W δv, W times the step
  std::vector<double> base_, change_;                         // b + S λ̄, y − λ̄
  std::vector<double> bound_;                                 // radii of discs
  std::vector<double> slope_, turned_;                        // P' in the rows turned_ of W
  Eigen::VectorXd v_, gradient_, step_;  // δv = v − Wᵀ λ̄, so that round-off is that of small numbers
  // s of contacts, what a round makes of it less that, and both of the round before [√J]
  Eigen::VectorXd s_, f_, last_s_, last_f_, next_;
  Eigen::MatrixXd steps_, changes_;
  int rounds_ = 0, remembered_ = 0, mode_rounds_ = 0;
  Mode mode_ = Mode::kSlip, lagged_ = Mode::kSlip;
  std::vector<double> coupling_;       // ∂y_t/∂y_n of each contact along its slip
  bool soft_ = false;                  // a contact is compliant
  std::vector<double> best_, best_w_;  // λ and w of the round with the least residual and closed joints
  double best_residual_ = 0;
  // The last good round with nothing lagged, and what it is measured by.
  std::vector<double> kept_;
  double kept_residual_ = 0, looked_residual_ = 0;
  int hold_ = 0;  // rounds that are to go well before Σ falls again
  // GMRES: its vectors, R and the turns that make it, and what is left of the right side.
  std::vector<Eigen::VectorXd> basis_;
  Eigen::MatrixXd krylov_;
  Eigen::VectorXd krylov_residual_;
  std::vector<Eigen::JacobiRotation<double>> krylov_turns_;
};

}  // namespace taut
