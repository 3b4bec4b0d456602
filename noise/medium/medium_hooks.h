/// Names that a medium's parameter header needs to declare its hooks (noise/medium/medium_spec.h).
#pragma once

#include <vector>

#include "noise/math/random.h"
#include "noise/medium/optics.h"

namespace eikonal {

class Key;
using Keys = std::vector<Key>;
class Medium;
struct MediumSetting;

}  // namespace eikonal
