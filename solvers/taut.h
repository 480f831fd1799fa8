#pragma once

/// What programs that simulate need, joint types of their own included; they include it as taut/taut.h.
/// Beside it, by their own names: solvers/friction/friction_solver.h (friction problems of others) and
/// solvers/integrators/reduced/tree_dynamics.h (accelerations in reduced coordinates).
#include "collision/contact_finder.h"
#include "collision/mesh/mesh_file.h"
#include "core/joints/joints.h"
#include "core/math/so3.h"
#include "core/state/force.h"
#include "core/state/motion.h"
#include "core/state/state.h"
#include "core/world/applied_force.h"
#include "core/world/diagnostics.h"
#include "core/world/joint_frame.h"
#include "core/world/rigid_body.h"
#include "core/world/shape.h"
#include "core/world/solid.h"
#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/simulator/simulator.h"
