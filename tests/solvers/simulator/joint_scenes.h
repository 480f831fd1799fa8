#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace taut {

/// One small scene of each kind that is made of joints alone, with its parameters.
inline const std::vector<std::pair<std::string, std::map<std::string, double>>> kJointScenes = {
    {"pendulum-ball", {{"n", 2}}}, {"pendulum-hinge", {{"n", 2}}},
    {"chain", {{"n", 10}}},        {"chain-heavy", {{"n", 10}}},
    {"bridge-hinge", {{"n", 10}}}, {"bridge-hinge", {{"n", 10}, {"truck", 1}}},
    {"bridge-balls", {{"n", 10}}}, {"bridge-balls", {{"n", 10}, {"truck", 1}}},
    {"net-flag", {{"n", 10}}},     {"net-corners", {{"n", 10}}},
    {"joint-grid", {{"n", 10}}},   {"joint-grid", {{"n", 10}, {"swing", 1}}}};

}  // namespace taut
