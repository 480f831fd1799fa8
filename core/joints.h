#pragma once

/// All joint types.  The library itself never needs this list.
#include "core/joints/ball.h"
#include "core/joints/distance.h"
#include "core/joints/fixed.h"
#include "core/joints/hinge.h"
#include "core/joints/slider.h"
#include "core/joints/universal.h"
