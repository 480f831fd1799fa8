#pragma once

#include <string>
#include <vector>

struct FrictionContactProblem;  // of Siconos

/// The friction solvers of Siconos' numerics behind a face without its types, whose headers are no C++20.
namespace taut::peers {

/// What is asked of one call.
struct SiconosFrictionSettings {
  std::string solver;       ///< vi, prox, nsn, nsgs or admm
  double tolerance = 1e-8;  ///< of Siconos' own error, which depends on units
  int iterations = 1'000'000;
};

/// What it has left.
struct SiconosFrictionOutcome {
  int info = 0;        ///< 0: it says that it has solved it
  int iterations = 0;  ///< that it counts
};

/// A problem in the text form that Siconos reads, kept until it is destroyed.
class SiconosFriction {
 public:
  /// @throws std::runtime_error if Siconos cannot read it.
  explicit SiconosFriction(const std::string& text);
  ~SiconosFriction();
  SiconosFriction(const SiconosFriction&) = delete;
  SiconosFriction& operator=(const SiconosFriction&) = delete;

  /// `r`: a guess, then impulses, normal and two tangents a contact.
  /// @throws std::invalid_argument for a solver of another name.
  SiconosFrictionOutcome solve(const SiconosFrictionSettings& settings, std::vector<double>& r);

 private:
  FrictionContactProblem* problem_;
};

}  // namespace taut::peers
