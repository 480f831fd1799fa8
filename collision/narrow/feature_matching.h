#pragma once

#include <functional>
#include <span>
#include <vector>

#include "collision/narrow/contact.h"

namespace taut::detail {

/// Makes the features of `now` those of `before` where they are the same contact: equal feature, or else the
/// nearest one within near(contact) [m] in both body frames that no other contact took.  What is left keeps
/// its own feature, changed if it is taken.  Both lists are sorted by pair, and `now` is sorted by feature
/// afterwards.
void match_features(std::span<const Contact> before, std::span<Contact> now,
                    const std::function<double(const Contact&)>& near);

}  // namespace taut::detail
