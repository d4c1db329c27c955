// Reads textures and writes pictures.
#pragma once
#include "vitral/error.h"
#include "vitral/image.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <string>

namespace vitral {

// PNG, JPEG, TGA or BMP, at most 16384 pixels a side. Throws InputError.
Texture load_texture(const std::string& path);

// "-" is standard output. A regular file is written whole under a temporary name in the same folder
// and then renamed, so that what stands at `path` is never half of a picture. Throws InputError.
void write_png(const std::string& path, const Image<Rgb8>& image);
void write_pfm(const std::string& path, const Aov& aov);

// Reads a PNG of 8 bits a channel (what write_png wrote), for comparing. Throws InputError.
Image<Rgb8> read_png(const std::string& path);

// Throws InputError with the reason when a file could not be written at `path`: no such folder, a
// directory, no permission. Leaves nothing behind.
void check_writable(const std::string& path);

}  // namespace vitral
