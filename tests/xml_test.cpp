// What the XML reader accepts, and the line it names for everything that it refuses.
#include "io/xml.h"

#include "scratch.h"

#include <gtest/gtest.h>

#include <string>

namespace vitral {
namespace {

// What parsing `text` complains about; empty when it does not.
std::string complaint(const std::string& text) {
  try {
    parse_xml(text, "f.xml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string repeated(const std::string& text, size_t count) {
  std::string result;
  for (size_t i = 0; i < count; ++i) result += text;
  return result;
}

TEST(Xml, ReadsElementsAttributesAndText) {
  const XmlElement root = parse_xml(
      "\xef\xbb\xbf<?xml version=\"1.0\"?>\n<!-- a comment with <tags> & -- dashes -->\n"
      "<project width=1024 height='768' name = \"a > b\">\n"
      "  <empty/>\n"
      "  <file>\n    ../a.obj\n  </file >\n"
      "</project>\n<!-- the end -->\n",
      "f.xml");
  EXPECT_EQ(root.name, "project");
  EXPECT_EQ(root.line, 3u);
  ASSERT_EQ(root.attributes.size(), 3u);
  EXPECT_EQ(root.attributes[0].name, "width");
  EXPECT_EQ(root.attributes[0].value, "1024");
  EXPECT_EQ(root.attributes[1].value, "768");
  EXPECT_EQ(root.attributes[2].value, "a > b");
  ASSERT_EQ(root.children.size(), 2u);
  EXPECT_EQ(root.children[0].name, "empty");
  EXPECT_EQ(root.children[0].line, 4u);
  EXPECT_EQ(root.children[1].text, "../a.obj");
  EXPECT_EQ(root.children[1].line, 5u);
}

TEST(Xml, BareValuesEndAtSpaceOrAtTheTag) {
  const XmlElement root = parse_xml("<a x=1 f=../b/c.obj/>", "f.xml");
  ASSERT_EQ(root.attributes.size(), 2u);
  EXPECT_EQ(root.attributes[1].value, "../b/c.obj");
  EXPECT_NE(complaint("<a f=b/></a>"), "") << "the slash ended the element";
}

TEST(Xml, ResolvesTheFiveEntitiesAndNoOther) {
  const XmlElement root = parse_xml("<a x=\"&lt;&gt;&amp;&quot;&apos;\" y=&lt;>&amp;lt;</a>", "f.xml");
  EXPECT_EQ(root.attributes[0].value, "<>&\"'");
  EXPECT_EQ(root.attributes[1].value, "<");
  EXPECT_EQ(root.text, "&lt;") << "an entity is resolved once";
  EXPECT_EQ(complaint("<a>\n&nbsp;</a>"), "f.xml:2: unknown entity '&nbsp;</a>'");
  EXPECT_EQ(complaint("<a>&#65;</a>"), "f.xml:1: unknown entity '&#65;</a>'");
}

TEST(Xml, RefusesDocumentTypes) {
  const std::string bomb =
      "<?xml version='1.0'?>\n<!DOCTYPE a [<!ENTITY b SYSTEM \"/etc/passwd\">]>\n<a>&b;</a>";
  EXPECT_EQ(complaint(bomb), "f.xml:2: document types (<!DOCTYPE ...>) and entities are not accepted");
  EXPECT_NE(complaint("<a><!ENTITY b 'c'></a>"), "");
  EXPECT_NE(complaint("<a><![CDATA[x]]></a>"), "");
}

TEST(Xml, NamesTheLineOfWhatIsWrong) {
  EXPECT_EQ(complaint("<a>\n <b>\n </a>"), "f.xml:3: </a> ends <b> of line 2");
  EXPECT_EQ(complaint("<a>\n <b>"), "f.xml:2: <b> has no end");
  EXPECT_EQ(complaint("<a>\n\n<b x=\"1></b></a>"), "f.xml:3: the value of 'x' has no closing quote");
  EXPECT_EQ(complaint("<a\n x=1\n x=2/>"), "f.xml:3: attribute 'x' is given twice");
  EXPECT_EQ(complaint("<a x/>"), "f.xml:1: attribute 'x' has no value");
  EXPECT_EQ(complaint("<a x=></a>"), "f.xml:1: attribute 'x' has no value");
  EXPECT_EQ(complaint("<a x='1'y='2'/>"), "f.xml:1: expected a space before 'y='2'/>'");
  EXPECT_EQ(complaint("<a/>\n<b/>"), "f.xml:2: something follows the end of <a>");
  EXPECT_EQ(complaint("<!-- never closed"), "f.xml:1: this comment has no end");
  EXPECT_EQ(complaint("v 0 0 0\n"), "f.xml:1: expected <, found 'v 0 0 0?'");
  EXPECT_EQ(complaint("\n\n"), "f.xml:3: there is no XML element in this file");
  EXPECT_EQ(complaint(""), "f.xml:1: there is no XML element in this file");
  EXPECT_NE(complaint(std::string("<a>\0</a>", 8)), "") << "a NUL";
  EXPECT_NE(complaint("\xff\xfe<\0a\0"), "") << "UTF-16";
}

TEST(Xml, EveryPrefixOfAGoodFileIsAnErrorAndNothingWorse) {
  const std::string good = "<?xml version='1.0'?><!-- c --><a x=1 y=\"&amp;\"><b>text &lt;</b><c z='3'/></a>";
  ASSERT_EQ(complaint(good), "");
  for (size_t length = 0; length < good.size(); ++length) {
    EXPECT_NE(complaint(good.substr(0, length)), "") << "the first " << length << " bytes";
  }
  // No byte in any place crashes it.
  for (size_t at = 0; at < good.size(); ++at) {
    for (const char c : {'<', '>', '&', '"', '\0', '/', '=', '!', '\xff'}) {
      std::string bad = good;
      bad[at] = c;
      complaint(bad);
    }
  }
}

TEST(Xml, BoundsDepthCountAndSize) {
  const auto nested = [](size_t depth) { return repeated("<a>", depth) + repeated("</a>", depth); };
  EXPECT_EQ(complaint(nested(kMaxXmlDepth)), "");
  EXPECT_NE(complaint(nested(kMaxXmlDepth + 1)), "");
  EXPECT_NE(complaint(repeated("<a>", 1000000)), "") << "a million open elements";

  EXPECT_EQ(complaint("<r>" + repeated("<a/>", kMaxXmlNodes - 1) + "</r>"), "");
  EXPECT_NE(complaint("<r>" + repeated("<a/>", kMaxXmlNodes) + "</r>"), "");

  std::string attributes = "<r";
  for (size_t i = 0; i <= kMaxXmlAttributes; ++i) attributes += " a" + std::to_string(i) + "=1";
  EXPECT_NE(complaint(attributes + "/>"), "");

  EXPECT_NE(complaint("<r>" + std::string(kMaxXmlBytes, ' ') + "</r>"), "");
}

TEST(Xml, MessagesStayOnOneShortLine) {
  const std::string message = complaint("<a><" + std::string(100000, 'b') + "\x01\n></a>");
  EXPECT_NE(message, "");
  EXPECT_LT(message.size(), 200u);
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(Xml, ReadsFilesAndNothingElse) {
  const test::ScratchFolder folder;
  EXPECT_EQ(read_xml(folder.write("a.xml", "<a/>")).name, "a");
  EXPECT_THROW(read_xml(folder / "nosuch.xml"), InputError);
  EXPECT_THROW(read_xml(folder.path().string()), InputError);
  EXPECT_THROW(read_xml("/dev/zero"), InputError);
}

}  // namespace
}  // namespace vitral
