// Refuses JPEG files that stb_image 2.27 must not see.
#pragma once
#include <string>
#include <string_view>

namespace vitral {

// Follows the markers through the file, as the decoder will. Throws InputError when a Huffman table
// has more than 256 symbols, which the decoder would write beyond its memory, or when there are more
// than 1000 scans, each of which goes over the whole picture.
void check_jpeg(const std::string& path, std::string_view bytes);

}  // namespace vitral
