// Decoding of pictures, with what a texture's user needs to know besides the texels.
#pragma once
#include "vitral/scene.h"

#include <string>

namespace vitral {

enum class Alpha { none, stored };

struct DecodedTexture {
  Texture texture;
  Alpha alpha = Alpha::none;  // none: the file has no alpha channel, and the texels are opaque
};

// load_texture() of image_file.h is the texture of this. Throws InputError.
DecodedTexture decode_texture(const std::string& path);

}  // namespace vitral
