#pragma once

/// The whole library:  #include <taut/taut.h>
#include "collision/contact_finder.h"
#include "collision/mesh_file.h"
#include "core/diagnostics.h"
#include "core/force.h"
#include "core/joints.h"
#include "core/rigid_body.h"
#include "core/shape.h"
#include "core/so3.h"
#include "core/solid.h"
#include "core/state.h"
#include "core/world.h"
#include "solvers/settings.h"
#include "solvers/simulator.h"
#include "solvers/step_report.h"
#include "solvers/tree_dynamics.h"
