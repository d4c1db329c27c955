#include "io/obj_chunk.h"

#include "io/memory.h"
#include "io/text.h"

#include <algorithm>
#include <cstring>
#include <map>

namespace vitral {
namespace {

constexpr size_t kLookAhead = 4096;                  // enough for nearly every statement
constexpr size_t kMaxStatement = size_t{256} << 20;  // bytes

// Reads the statements of one chunk. Every `read_` function leaves the cursor somewhere before the
// end of the statement's line.
class ChunkReader {
 public:
  ChunkReader(Cursor cursor, const char* last_start, ObjChunk& chunk)
      : c_(cursor), last_start_(last_start), chunk_(chunk) {}

  // Statements that start before `last_start`, until one is wrong.
  void run() {
    c_.line = 0;
    while (c_.p < last_start_ && chunk_.error.text.empty()) {
      skip_blanks(c_);
      statement_line_ = c_.line;
      if (!at_line_end(c_)) read_statement();
      skip_line(c_);
    }
    chunk_.lines = c_.line;
  }

 private:
  void read_statement() {
    const char* const start = c_.p;
    if (start[0] == 'v' && is_blank(start[1])) {
      ++c_.p;
      ++chunk_.statements;
      return read_position();
    }
    if (start[0] == 'f' && is_blank(start[1])) {
      ++c_.p;
      ++chunk_.statements;
      return read_face();
    }
    const std::string_view keyword = read_word(c_);
    if (keyword == "vt") {
      read_texcoord();
    } else if (keyword == "vn") {
      read_normal();
    } else if (keyword == "f" || keyword == "fo") {  // fo: an old spelling
      read_face();
    } else if (keyword == "v") {
      read_position();
    } else if (keyword == "usemtl") {
      read_material();
    } else if (keyword == "s") {
      read_smoothing();
    } else if (keyword == "mtllib") {
      skip_blanks(c_);
      chunk_.libraries.push_back({statement_line_, read_rest(c_), 1});
    } else if (keyword == "g" || keyword == "o") {
      // Groups and objects make no difference to the picture.
    } else {
      return note(chunk_.skipped, keyword);
    }
    ++chunk_.statements;
  }

  void note(ObjNote& note, std::string_view text) const {
    if (note.count++ > 0) return;
    note.line = statement_line_;
    note.text = printable(text);
  }

  void fail_here(const std::string& reason) const {
    if (chunk_.error.text.empty()) chunk_.error = {statement_line_, reason, 1};
  }

  // Reads a number that must be there; errors are found at the end of the statement.
  bool read_number(float& value) {
    skip_blanks(c_);
    if (read_float(c_, value) && (is_blank(*c_.p) || at_line_end(c_) || continuation(c_) > 0)) return true;
    fail_here(quoted(read_word(c_)) + " is not a number");
    return false;
  }
  bool more() {
    skip_blanks(c_);
    return !at_line_end(c_);
  }

  // What may follow, a weight or a colour, is left alone.
  void read_position() {
    Vec3 p;
    for (float* x : {&p.x, &p.y, &p.z}) {
      if (!more()) return fail_here("a vertex needs three coordinates");
      if (!read_number(*x)) return;
    }
    chunk_.positions.push_back(p);
  }

  void read_texcoord() {
    Vec2 t{0, 0};
    if (!more()) return fail_here("a texture coordinate is missing");
    if (!read_number(t.x)) return;
    if (more() && !read_number(t.y)) return;
    chunk_.texcoords.push_back(t);
  }

  void read_normal() {
    Vec3 n;
    for (float* x : {&n.x, &n.y, &n.z}) {
      if (!more()) return fail_here("a normal needs three components");
      if (!read_number(*x)) return;
    }
    chunk_.normals.push_back(n);
  }

  // Indices start at 1. `known` is how many elements this chunk holds so far.
  bool read_index(size_t known, uint32_t& index) {
    int64_t n = 0;
    if (!read_integer(c_, n)) {
      fail_here(quoted(read_word(c_)) + " is not an index");
      return false;
    }
    if (n > 0 && n <= kLargestIndex) {
      index = static_cast<uint32_t>(n - 1);
      return true;
    }
    if (n < 0 && n > -(int64_t{1} << 30) && known < (size_t{1} << 30)) {
      index = kRelative + static_cast<uint32_t>(static_cast<int64_t>(known) + n);
      return true;
    }
    fail_here(n == 0 ? "index 0: indices start at 1" : "index " + std::to_string(n) + " is out of range");
    return false;
  }

  // One corner: v, v/vt, v//vn or v/vt/vn, where what follows a slash may be missing.
  bool read_corner(ObjCorner& corner) {
    corner = {kNoIndex, kNoIndex, kNoIndex};
    if (!read_index(chunk_.positions.size(), corner.position)) return false;
    const auto given = [this] {
      if (*c_.p != '/') return false;
      ++c_.p;
      return *c_.p != '/' && !is_blank(*c_.p) && !is_newline(*c_.p) && continuation(c_) == 0;
    };
    if (given() && !read_index(chunk_.texcoords.size(), corner.texcoord)) return false;
    if (given() && !read_index(chunk_.normals.size(), corner.normal)) return false;
    if (is_blank(*c_.p) || at_line_end(c_) || continuation(c_) > 0) return true;
    fail_here(quoted(read_word(c_)) + " after a face's corner");
    return false;
  }

  void read_face() {
    const size_t first = chunk_.corners.size();
    while (more()) {
      ObjCorner corner;
      if (!read_corner(corner)) return;
      (corner.normal == kNoIndex ? chunk_.corners_without_normal : chunk_.corners_with_normal) = true;
      if (corner.texcoord != kNoIndex) chunk_.corners_with_texcoord = true;
      chunk_.corners.push_back(corner);
    }
    const size_t n = chunk_.corners.size() - first;
    if (n < 3) {
      chunk_.corners.resize(first);
      return note(chunk_.small_faces, "f");
    }
    chunk_.faces.push_back({static_cast<uint32_t>(n), static_cast<uint32_t>(statement_line_)});
    chunk_.triangles += n - 2;
  }

  ObjState& new_state() {
    const auto face = static_cast<uint32_t>(chunk_.faces.size());
    if (chunk_.states.empty()) {
      chunk_.states.push_back({face, kNoIndex, 0, false});
    } else if (chunk_.states.back().face != face) {
      chunk_.states.push_back(chunk_.states.back());
      chunk_.states.back().face = face;
    }
    return chunk_.states.back();
  }

  void read_material() {
    skip_blanks(c_);
    const std::string name = read_rest(c_);
    const auto [entry, is_new] = names_.try_emplace(name, static_cast<uint32_t>(names_.size()));
    if (is_new) {
      chunk_.material_names.push_back(name);
      chunk_.material_lines.push_back(statement_line_);
    }
    new_state().material = entry->second;
  }

  // A group number; "off" is 0, and any other word (some write "on") is taken for a group.
  void read_smoothing() {
    skip_blanks(c_);
    int64_t group = 0;
    if (!read_integer(c_, group)) group = at_line_end(c_) || read_word(c_) == "off" ? 0 : 1;
    ObjState& state = new_state();
    state.smoothing = static_cast<uint32_t>(group);
    state.smoothing_known = true;
    chunk_.smoothing = true;
  }

  Cursor c_;
  const char* last_start_;
  ObjChunk& chunk_;
  size_t statement_line_ = 0;
  std::map<std::string, uint32_t> names_;  // of materials, to their numbers
};

// The first byte of the first statement in [p, end): it follows a newline that continues nothing.
// At least three bytes are readable before p.
const char* find_statement(const char* p, const char* end) {
  for (; p < end; ++p) {
    const bool after_newline = p[-1] == '\n' || (p[-1] == '\r' && *p != '\n');
    if (!after_newline) continue;
    const char* const before = p[-1] == '\n' && p[-2] == '\r' ? p - 3 : p - 2;
    if (*before != '\\') return p;
  }
  return end;
}

// The bytes of a file from three before `begin` on, where line feeds stand in front of the file.
class Window {
 public:
  Window(const InputFile& file, uint64_t begin, std::vector<char>& buffer)
      : file_(file), begin_(begin), buffer_(buffer) {
    const auto lead = static_cast<size_t>(std::min<uint64_t>(begin, 3));
    if (buffer_.size() < 4) buffer_.resize(4);
    std::memset(buffer_.data(), '\n', 3);
    file_.read(begin_ - lead, {buffer_.data() + 3 - lead, lead});
  }

  // Makes at least `size` bytes after `begin` readable, or all that there are.
  void extend(uint64_t size) {
    const auto wanted = static_cast<size_t>(std::min(size, file_.size() - begin_));
    if (wanted <= size_) return;
    if (buffer_.size() < wanted + 4) {
      prefer_large_pages(buffer_.data(), buffer_.capacity());
      buffer_.resize(wanted + 4);
    }
    file_.read(begin_ + size_, {buffer_.data() + 3 + size_, wanted - size_});
    size_ = wanted;
    buffer_[3 + size_] = '\n';  // the sentinel of Cursor
  }

  const char* text() const { return buffer_.data() + 3; }
  size_t size() const { return size_; }
  bool at_end_of_file() const { return begin_ + size_ == file_.size(); }

 private:
  const InputFile& file_;
  uint64_t begin_;
  std::vector<char>& buffer_;
  size_t size_ = 0;
};

}  // namespace

ObjChunk read_obj_chunk(const InputFile& file, uint64_t begin, uint64_t end, std::vector<char>& buffer) {
  ObjChunk chunk;

  const auto length = static_cast<size_t>(end - begin);
  Window window(file, begin, buffer);
  window.extend(length + kLookAhead);
  if (begin == 0 && std::memchr(window.text(), '\0', std::min<size_t>(window.size(), 4096)) != nullptr) {
    chunk.error = {0, "not an OBJ file: it holds binary data", 1};
    return chunk;
  }
  if (find_statement(window.text(), window.text() + length) == window.text() + length) return chunk;

  // Read on until another statement begins: then the last of this chunk is whole.
  while (!window.at_end_of_file() && find_statement(window.text() + length, window.text() + window.size()) ==
                                         window.text() + window.size()) {
    if (window.size() > length + kMaxStatement) fail(file.path(), "a line is longer than 256 MiB");
    window.extend(2 * window.size());
  }
  const char* const text = window.text();
  const bool has_mark =
      begin == 0 && window.size() >= 3 && std::memcmp(text, "\xef\xbb\xbf", 3) == 0;  // UTF-8
  const char* const start = has_mark ? text + 3 : find_statement(text, text + length);
  reserve_large(chunk.positions, length / 24);
  reserve_large(chunk.corners, length / 12);
  reserve_large(chunk.faces, length / 40);
  ChunkReader(Cursor{start, text + window.size(), 0}, text + length, chunk).run();
  return chunk;
}

}  // namespace vitral
