#pragma once

/// The whole library; programs include it as taut/taut.h.
#include "collision/contact_finder.h"
#include "collision/mesh/mesh_file.h"
#include "core/joints/joints.h"
#include "core/math/so3.h"
#include "core/state/force.h"
#include "core/state/state.h"
#include "core/world/diagnostics.h"
#include "core/world/rigid_body.h"
#include "core/world/shape.h"
#include "core/world/solid.h"
#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/integrators/tree_dynamics.h"
#include "solvers/simulator/simulator.h"
