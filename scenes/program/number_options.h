#pragma once

#include "solvers/common/settings.h"

namespace taut {

/// An option of `taut run` that is a number among the Settings.
struct NumberOption {
  const char *option, *key;   ///< "--theta", and "theta" in scene files
  double Settings::*setting;  ///< the member
  const char* help;           ///< for --help
};
/// All of them.
inline constexpr NumberOption kNumberOptions[] = {
    {"--erp", "erp", &Settings::erp,
     "of baumgarte, velocity-impulse, position-push: part of the gaps that a step takes out, default 0.8"},
    {"--cfm", "cfm", &Settings::cfm,
     "of baumgarte: compliance of each row of a joint, in parts of its diagonal in S, default 0"},
    {"--penalty-frequency", "penalty_frequency", &Settings::penalty_frequency,
     "of penalty: its springs on the bodies' own inertia [Hz], default 50"},
    {"--penalty-damping-ratio", "penalty_damping_ratio", &Settings::penalty_damping_ratio,
     "of penalty, 1: critical, default 1"},
    {"--theta", "theta", &Settings::theta, "of moreau-jean, 1/2 to 1, default 1/2"},
    {"--relaxation", "relaxation", &Settings::relaxation, "over-relaxation of gauss-seidel, between 0 and 2"},
};

}  // namespace taut
