// Encodes pictures as PNG (RFC 2083).
#pragma once
#include "vitral/image.h"

#include <string>

namespace vitral {

// 8 bits a channel, RGB, without any ancillary chunk: the same picture gives the same bytes.
std::string encode_png(const Image<Rgb8>& image);

}  // namespace vitral
