#include "io/xml.h"

#include "io/file.h"
#include "io/text.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace vitral {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '.' || c == ':' || static_cast<unsigned char>(c) >= 0x80;
}

std::string trimmed(const std::string& text) {
  const auto first = std::find_if_not(text.begin(), text.end(), is_space);
  const auto last = std::find_if_not(text.rbegin(), std::make_reverse_iterator(first), is_space).base();
  return {first, last};
}

// A position in the text that knows its line. Reading past the end gives NUL, which no valid file holds.
class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  XmlElement document() {
    // A byte order mark is skipped; a NUL means UTF-16 or no text at all.
    accept("\xef\xbb\xbf");
    if (text_.find('\0') != std::string_view::npos) error("this is not XML in UTF-8");
    skip_between_elements();
    if (at_end()) error("there is no XML element in this file");
    if (peek() != '<') error("expected <, found '" + printable(text_.substr(position_, 20)) + "'");
    XmlElement root = element(1);
    skip_between_elements();
    if (!at_end()) error("something follows the end of <" + printable(root.name) + ">");
    return root;
  }

 private:
  [[noreturn]] void error(const std::string& reason) const { fail(file_, line_, reason); }

  bool at_end() const { return position_ >= text_.size(); }
  char peek() const { return at_end() ? '\0' : text_[position_]; }
  bool starts_with(std::string_view word) const { return text_.substr(position_).starts_with(word); }

  void advance(size_t count) {
    const std::string_view passed = text_.substr(position_, count);
    line_ += static_cast<size_t>(std::count(passed.begin(), passed.end(), '\n'));
    position_ += passed.size();
  }

  bool accept(std::string_view word) {
    if (!starts_with(word)) return false;
    advance(word.size());
    return true;
  }

  void skip_spaces() {
    while (is_space(peek())) advance(1);
  }

  void skip_past(std::string_view end, const std::string& what) {
    const size_t found = text_.find(end, position_);
    if (found == std::string_view::npos) error(what + " has no end");
    advance(found + end.size() - position_);
  }

  // Comments and processing instructions (the `<?xml ...?>` prolog is one) say nothing to us.
  bool skip_markup() {
    if (starts_with("<!--")) {
      advance(4);
      skip_past("-->", "this comment");
      return true;
    }
    if (starts_with("<?")) {
      skip_past("?>", "this <? ... ?>");
      return true;
    }
    if (starts_with("<![CDATA[")) error("CDATA sections are not accepted");
    if (starts_with("<!")) error("document types (<!DOCTYPE ...>) and entities are not accepted");
    return false;
  }

  void skip_between_elements() {
    do skip_spaces();
    while (skip_markup());
  }

  std::string name(const char* what) {
    const size_t begin = position_;
    while (is_name_character(peek())) ++position_;
    if (position_ == begin) {
      error(std::string("expected ") + what + ", found '" + printable(text_.substr(position_, 20)) + "'");
    }
    return std::string(text_.substr(begin, position_ - begin));
  }

  void count_node() {
    if (++nodes_ > kMaxXmlNodes)
      error("more than " + std::to_string(kMaxXmlNodes) + " elements and attributes");
  }

  char entity() {
    static constexpr std::pair<std::string_view, char> kEntities[] = {
        {"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}};
    for (const auto& [spelling, character] : kEntities) {
      if (accept(spelling)) return character;
    }
    error("unknown entity '" + printable(text_.substr(position_, 12)) + "'");
  }

  // The text up to a character of `ends`; the end of the file ends it too, and the caller complains.
  std::string characters(std::string_view ends) {
    std::string result;
    while (!at_end() && ends.find(peek()) == std::string_view::npos) {
      if (peek() == '&') {
        result += entity();
      } else {
        result += peek();
        advance(1);
      }
    }
    return result;
  }

  // name="value", name='value' or name=value; a bare value ends at a space, at > or at />.
  XmlAttribute attribute() {
    count_node();
    XmlAttribute result{name("an attribute, > or />"), {}};
    skip_spaces();
    if (!accept("=")) error("attribute '" + printable(result.name) + "' has no value");
    skip_spaces();
    const char quote = peek();
    if (quote == '"' || quote == '\'') {
      advance(1);
      result.value = characters(std::string_view(&quote, 1));
      if (at_end()) error("the value of '" + printable(result.name) + "' has no closing quote");
      advance(1);
    } else {
      while (!at_end() && !is_space(peek()) && peek() != '>' && !starts_with("/>")) {
        if (peek() == '"' || peek() == '\'' || peek() == '<') {
          error("unexpected " + std::string(1, peek()) + " in the value of '" + printable(result.name) + "'");
        }
        result.value += peek() == '&' ? entity() : text_[position_++];
      }
      if (result.value.empty()) error("attribute '" + printable(result.name) + "' has no value");
    }
    return result;
  }

  // <name attributes> text and children </name>, or <name attributes/>.
  XmlElement element(size_t depth) {
    if (depth > kMaxXmlDepth) error("elements are nested deeper than " + std::to_string(kMaxXmlDepth));
    count_node();
    XmlElement result;
    result.line = line_;
    advance(1);
    result.name = name("the name of an element");

    for (;;) {
      const bool separated = is_space(peek());
      skip_spaces();
      if (accept("/>")) return result;
      if (accept(">")) break;
      if (at_end()) fail(file_, result.line, "<" + printable(result.name) + "> has no end");
      if (!separated) error("expected a space before '" + printable(text_.substr(position_, 20)) + "'");
      if (result.attributes.size() == kMaxXmlAttributes) {
        error("more than " + std::to_string(kMaxXmlAttributes) + " attributes in one element");
      }
      XmlAttribute next = attribute();
      for (const XmlAttribute& earlier : result.attributes) {
        if (earlier.name == next.name) error("attribute '" + printable(next.name) + "' is given twice");
      }
      result.attributes.push_back(std::move(next));
    }

    for (;;) {
      result.text += characters("<");
      if (at_end()) fail(file_, result.line, "<" + printable(result.name) + "> has no end");
      if (accept("</")) break;
      if (!skip_markup()) result.children.push_back(element(depth + 1));
    }
    const std::string closing = name("the name of the element that ends here");
    skip_spaces();
    if (closing != result.name || !accept(">")) {
      error("</" + printable(closing) + "> ends <" + printable(result.name) + "> of line " +
            std::to_string(result.line));
    }
    result.text = trimmed(result.text);
    return result;
  }

  std::string_view text_;
  const std::string& file_;
  size_t position_ = 0;
  size_t line_ = 1;
  size_t nodes_ = 0;
};

}  // namespace

XmlElement parse_xml(std::string_view text, const std::string& file) {
  if (text.size() > kMaxXmlBytes) fail(file, "larger than " + std::to_string(kMaxXmlBytes >> 20) + " MiB");
  return Parser(text, file).document();
}

XmlElement read_xml(const std::string& path) {
  return parse_xml(read_file(path, kMaxXmlBytes), path);
}

}  // namespace vitral
