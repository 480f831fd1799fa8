#include "core/world/world_parts.h"

#include <memory>
#include <utility>

#include "core/world/world.h"

namespace taut::detail {

OwnWorldParts::OwnWorldParts() : parts_(std::make_unique<WorldParts>()) {}

OwnWorldParts::OwnWorldParts(const OwnWorldParts& other)
    : parts_(std::make_unique<WorldParts>(*other.parts_)) {}

// NOLINTNEXTLINE(performance-noexcept-move-constructor): throws where a world is held
OwnWorldParts::OwnWorldParts(OwnWorldParts&& other) : OwnWorldParts() { *this = std::move(other); }

OwnWorldParts& OwnWorldParts::operator=(const OwnWorldParts& other) {
  parts_->identity.require_free();
  parts_ = std::make_unique<WorldParts>(*other.parts_);
  return *this;
}

/// Both worlds are others afterwards.  One that is moved to itself has nothing, as its State has then.
// NOLINTNEXTLINE(performance-noexcept-move-constructor)
OwnWorldParts& OwnWorldParts::operator=(OwnWorldParts&& other) {
  parts_->identity.require_free();
  other.parts_->identity.require_free();
  auto taken = std::exchange(other.parts_, std::make_unique<WorldParts>());
  if (&other == this) return *this;
  parts_ = std::move(taken);
  parts_->identity = {};
  return *this;
}

OwnWorldParts::~OwnWorldParts() = default;

}  // namespace taut::detail
