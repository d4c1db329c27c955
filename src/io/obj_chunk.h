// The first half of reading OBJ: text to numbers, one piece of the file at a time.
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include "io/file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace vitral {

// Indices of a face's corner as the file gives them, counted from 0. A negative index of the file
// counts backwards from the vertices read so far; how many those are is known only when all earlier
// chunks are, so it is kept relative to the start of its chunk. kNoIndex: not given.
struct ObjCorner {
  uint32_t position, texcoord, normal;
};

inline constexpr uint32_t kRelative = 0xc0000000u;      // relative indices are stored as this + offset
inline constexpr uint32_t kLargestIndex = 0x7fffffffu;  // all above are relative

struct ObjFace {
  uint32_t corners;  // 3 or more
  uint32_t line;     // within the chunk, from 0
};

// Material and smoothing group from one face on.
struct ObjState {
  uint32_t face;      // number within the chunk
  uint32_t material;  // into ObjChunk::material_names; kNoIndex: as before this chunk
  uint32_t smoothing;
  bool smoothing_known;  // false: as before this chunk
};

// A statement that names something, or the first of several that are counted.
struct ObjNote {
  size_t line = 0;  // within the chunk, from 0
  std::string text;
  size_t count = 0;
};

struct ObjChunk {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> texcoords;
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
  std::vector<ObjState> states;
  std::vector<std::string> material_names;
  std::vector<size_t> material_lines;  // where each is named first
  std::vector<ObjNote> libraries;      // the text after mtllib
  ObjNote skipped;                     // statements that are not understood, or that make no surface
  ObjNote small_faces;                 // faces of one or two corners
  ObjNote error;                       // reading stopped here; its text is empty when there was none
  size_t lines = 0;                    // read
  size_t triangles = 0;                // faces cut into triangles
  size_t statements = 0;               // understood
  bool smoothing = false;              // there is an `s` statement
  bool corners_without_normal = false, corners_with_normal = false;
  bool corners_with_texcoord = false;
};

// Reads the statements that start in bytes [begin, end) of the file. `buffer` is working memory. A
// statement belongs to the chunk its first byte lies in, wherever it ends, so that chunks can be
// read in any order. Throws InputError when the file cannot be read.
ObjChunk read_obj_chunk(const InputFile& file, uint64_t begin, uint64_t end, std::vector<char>& buffer);

}  // namespace vitral
