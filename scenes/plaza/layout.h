#pragma once
#include "geometry.h"

namespace plaza {

// Builds everything where it stands.
void lay_out(Mesh& mesh);

}  // namespace plaza
