// The command line as a list of words: what it means, and one line for what makes no sense.
#include "app/options.h"
#include "app/option_table.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace vitral {
namespace {

using Words = std::vector<std::string>;

// What the parser complains about; empty when it does not.
std::string complaint(const Words& words) {
  try {
    parse_options(words);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

// Of one option given with a value.
std::string complaint(const std::string& option, const std::string& value) {
  return complaint(Words{"a.obj", option, value});
}

TEST(Options, RenderIsTheDefaultCommand) {
  const Options options = parse_options({"a.obj"});
  EXPECT_EQ(options.command, Command::render);
  EXPECT_EQ(options.inputs, Words{"a.obj"});
  EXPECT_EQ(options.output, "");
  EXPECT_FALSE(options.size || options.effects || options.eye || options.threads);

  EXPECT_EQ(parse_options({"render", "a.obj"}).command, Command::render);
  EXPECT_EQ(parse_options({"bench", "a.obj"}).command, Command::bench);
  EXPECT_EQ(parse_options({"info", "a.obj"}).command, Command::info);
  EXPECT_EQ(parse_options({"diff", "a.png", "b.png"}).inputs, (Words{"a.png", "b.png"}));
  EXPECT_EQ(parse_options({"--quiet", "bench", "a.obj"}).command, Command::bench);
}

TEST(Options, ReadsEveryOptionOfRender) {
  const Options o = parse_options({"a.xml",
                                   "-o",
                                   "b.png",
                                   "--pipeline=P",
                                   "--camera",
                                   "C",
                                   "--size",
                                   "640x480",
                                   "--crop",
                                   "10,20,30x40",
                                   "--eye",
                                   "-1,2.5,-3e2",
                                   "--view",
                                   "0,-1,0.5",
                                   "--up",
                                   "0,0,1",
                                   "--fov",
                                   "35.5",
                                   "--near",
                                   "0.25",
                                   "--far",
                                   "500",
                                   "--samples",
                                   "16",
                                   "--filter",
                                   "mitchell",
                                   "--aperture",
                                   "0.25",
                                   "--focus",
                                   "3.5",
                                   "--shutter",
                                   "-1,0.5",
                                   "--background",
                                   "0.5,1,2",
                                   "--sun",
                                   "1,-1,0",
                                   "--effects",
                                   "shadows,ao",
                                   "--ao-samples",
                                   "25",
                                   "--ao-distance",
                                   "2",
                                   "--ao-exponent",
                                   "1.6",
                                   "--max-depth",
                                   "7",
                                   "--min-importance",
                                   "0.1",
                                   "--fresnel",
                                   "schlick",
                                   "--threads",
                                   "3",
                                   "--isa",
                                   "avx2",
                                   "--seed",
                                   "4294967295",
                                   "--aov",
                                   "depth,ao,depth",
                                   "--primary",
                                   "trace",
                                   "--terminator",
                                   "smooth",
                                   "--stats",
                                   "-",
                                   "--quiet"});
  EXPECT_EQ(o.output, "b.png");
  EXPECT_EQ(o.pipeline, "P");
  EXPECT_EQ(o.camera, "C");
  EXPECT_EQ(o.size->width, 640);
  EXPECT_EQ(o.size->height, 480);
  EXPECT_EQ(o.crop->x, 10);
  EXPECT_EQ(o.crop->y, 20);
  EXPECT_EQ(o.crop->width, 30);
  EXPECT_EQ(o.crop->height, 40);
  EXPECT_EQ(*o.eye, (Vec3{-1, 2.5f, -300}));
  EXPECT_EQ(*o.view, (Vec3{0, -1, 0.5f}));
  EXPECT_EQ(*o.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(o.fov, 35.5f);
  EXPECT_EQ(o.near, 0.25f);
  EXPECT_EQ(o.far, 500);
  EXPECT_EQ(o.samples, 16);
  EXPECT_EQ(o.filter, Filter::mitchell);
  EXPECT_EQ(o.aperture, 0.25f);
  EXPECT_EQ(o.focus, 3.5f);
  EXPECT_EQ(o.shutter->open, -1);
  EXPECT_EQ(o.shutter->close, 0.5f);
  EXPECT_EQ(*o.sun, (Vec3{1, -1, 0}));
  EXPECT_EQ(*o.background, (Vec3{0.5f, 1, 2}));
  EXPECT_TRUE(o.effects->shadows && o.effects->ambient_occlusion);
  EXPECT_FALSE(o.effects->reflection || o.effects->refraction);
  EXPECT_EQ(o.ao_samples, 25);
  EXPECT_EQ(o.ao_distance, 2);
  EXPECT_EQ(o.ao_exponent, 1.6f);
  EXPECT_EQ(o.max_depth, 7);
  EXPECT_EQ(o.min_importance, 0.1f);
  EXPECT_EQ(o.fresnel, Fresnel::schlick);
  EXPECT_EQ(o.threads, 3);
  EXPECT_EQ(o.isa, Isa::avx2);
  EXPECT_EQ(o.seed, 4294967295u);
  EXPECT_EQ(o.aovs, (Words{"depth", "ao"})) << "each once";
  EXPECT_EQ(o.primary, Primary::trace);
  EXPECT_EQ(o.terminator, Terminator::smooth);
  EXPECT_EQ(o.stats, "-");
  EXPECT_TRUE(o.quiet);
}

TEST(Options, ValuesStandAloneOrAfterAnEqualsSign) {
  EXPECT_EQ(parse_options({"a.obj", "--fov=30"}).fov, 30);
  EXPECT_EQ(parse_options({"a.obj", "--view=-1,0,0"}).view->x, -1);
  EXPECT_EQ(parse_options({"a.obj", "--output=x=y.png"}).output, "x=y.png");
  EXPECT_EQ(parse_options({"a.obj", "-o", "-"}).output, "-");
  EXPECT_EQ(parse_options({"a.obj", "--fov", "30", "--fov", "50"}).fov, 50) << "the last one holds";
}

TEST(Options, TwoDashesEndTheOptions) {
  EXPECT_EQ(parse_options({"--", "--fov"}).inputs, Words{"--fov"});
  EXPECT_EQ(parse_options({"--", "info"}).inputs, Words{"info"});
  EXPECT_EQ(parse_options({"--quiet", "--", "-x.obj"}).inputs, Words{"-x.obj"});
}

TEST(Options, EffectsAreAListOrAllOrNone) {
  const auto count = [](const std::string& list) {
    const Effects e = *parse_options({"a.obj", "--effects", list}).effects;
    return e.shadows + 2 * e.reflection + 4 * e.refraction + 8 * e.ambient_occlusion;
  };
  EXPECT_EQ(count("none"), 0);
  EXPECT_EQ(count("all"), 15);
  EXPECT_EQ(count("reflection,refraction"), 6);
  EXPECT_NE(complaint("--effects", ""), "");
  EXPECT_NE(complaint("--effects", "shadows,"), "");
  EXPECT_NE(complaint("--effects", "shadows,none"), "");
}

TEST(Options, SuggestsTheNearestName) {
  EXPECT_EQ(complaint(Words{"a.obj", "--szie", "3x3"}), "unknown option --szie; did you mean --size?");
  EXPECT_EQ(complaint(Words{"a.obj", "--ao-sample=4"}),
            "unknown option --ao-sample; did you mean --ao-samples?");
  EXPECT_EQ(complaint(Words{"a.obj", "--xyzzy"}), "unknown option --xyzzy");
  EXPECT_EQ(complaint(Words{"a.obj", "-x"}), "unknown option -x");
  EXPECT_EQ(complaint(Words{"rendr", "a.obj"}), "unknown command 'rendr'; did you mean render?");
  EXPECT_NE(complaint("--aov", "dept").find("did you mean depth?"), std::string::npos);
  EXPECT_NE(complaint("--fresnel", "exakt").find("did you mean exact?"), std::string::npos);
}

TEST(Options, RefusesValuesOutOfRange) {
  for (const char* size : {"0x0", "100000x100000", "16385x1", "1x16385", "-1x5", "640", "640x", "x480",
                           "640x480x3", "640X480", "1e3x5", " 640x480", "99999999999999999999x1", ""}) {
    EXPECT_NE(complaint("--size", size), "") << size;
  }
  EXPECT_EQ(complaint("--size", "16384x16384"), "");
  const std::pair<const char*, std::vector<const char*>> bad[] = {
      {"--fov", {"0", "180", "-60", "nan", "inf", "1e99", "60deg", "", "0x10"}},
      {"--near", {"0", "-1", "nan"}},
      {"--eye", {"1,2", "1,2,3,4", "1,,2", "1,2,x", ",1,2", "1,2,3,", "1,2,nan", "1e30,0,0"}},
      {"--view", {"0,0,0"}},
      {"--samples", {"0", "-1", "65537", "1.5", ""}},
      {"--filter", {"gauss", ""}},
      {"--aperture", {"-1", "nan"}},
      {"--focus", {"0", "-2"}},
      {"--shutter", {"1", "2,1", "0,1,2", "a,b", ""}},
      {"--sun", {"0,0,0"}},
      {"--background", {"-1", "red", "1,2"}},
      {"--ao-samples", {"0", "2", "10", "1025", "1089", "-4", "4.0"}},
      {"--ao-distance", {"0", "-1"}},
      {"--ao-exponent", {"0", "-2"}},
      {"--max-depth", {"-1", "101", "1.5"}},
      {"--min-importance", {"-0.1", "1.1"}},
      {"--threads", {"0", "-1", "1025", "two"}},
      {"--seed", {"-1", "4294967296"}},
      {"--isa", {"sse", ""}},
      {"--primary", {"both"}},
      {"--terminator", {"", "soft", "Smooth"}},
      {"--aov", {"", "depth,"}},
      {"--crop", {"0,0,0x0", "-1,0,5x5", "1,2", "1,2,3x4x5"}},
      {"--output", {""}},
  };
  for (const auto& [option, values] : bad) {
    for (const char* value : values) {
      const std::string message = complaint(option, value);
      EXPECT_EQ(message.substr(0, std::string(option).size()), option)
          << option << " " << value << ": " << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }
}

TEST(Options, RefusesWhatDoesNotBelong) {
  EXPECT_EQ(complaint(Words{"a.obj", "--repeat", "3"}), "--repeat is not an option of render");
  EXPECT_EQ(complaint(Words{"info", "a.obj", "--size", "3x3"}), "--size is not an option of info");
  EXPECT_EQ(complaint(Words{"a.obj", "--quiet=yes"}), "--quiet takes no value");
  EXPECT_EQ(complaint(Words{"a.obj", "--fov"}), "--fov needs a value: DEG");
  EXPECT_EQ(complaint(Words{"a.obj", "--fov", "--near", "1"}), "--fov needs a value: DEG");
  EXPECT_NE(complaint(Words{}), "");
  EXPECT_NE(complaint(Words{""}), "");
  EXPECT_NE(complaint(Words{"a.obj", "b.obj"}), "");
  EXPECT_NE(complaint(Words{"diff", "a.png"}), "");
  EXPECT_NE(complaint(Words{"diff", "a.png", "b.png", "c.png"}), "");
}

TEST(Options, BenchHasTheOptionsOfRenderThatShapeAFrame) {
  for (const OptionRow& row : option_table()) {
    const bool about_files = row.name == "--output" || row.name == "--aov" || row.name == "--stats";
    if ((row.commands & bit(Command::render)) && !about_files) {
      EXPECT_TRUE(row.commands & bit(Command::bench)) << row.name;
    }
  }
  EXPECT_EQ(parse_options({"bench", "a.obj", "--repeat", "9", "--json"}).repeat, 9);
}

TEST(Options, HelpNamesEveryOption) {
  const auto names_all = [](Command topic, Command command) {
    const std::string page = help_page(topic);
    size_t count = 0;
    for (const OptionRow& row : option_table()) {
      if (!(row.commands & bit(command))) continue;
      ++count;
      EXPECT_NE(page.find(std::string(row.name)), std::string::npos) << row.name;
    }
    EXPECT_GT(count, 2u);
  };
  for (const Command command : {Command::render, Command::bench, Command::info, Command::diff}) {
    names_all(command, command);
    names_all(Command::help, command);
  }
  // Nothing is wider than a usual terminal of 100 columns.
  const std::string page = help_page(Command::help);
  for (size_t begin = 0; begin < page.size();) {
    const size_t end = page.find('\n', begin);
    EXPECT_LE(end - begin, 100u) << page.substr(begin, end - begin);
    begin = end + 1;
  }
}

TEST(Options, HelpAndVersionAreCommandsOfTheirOwn) {
  EXPECT_EQ(parse_options({"--version"}).command, Command::version);
  EXPECT_EQ(parse_options({"--help"}).command, Command::help);
  EXPECT_EQ(parse_options({"-h"}).command, Command::help);
  EXPECT_EQ(parse_options({"help"}).help_topic, Command::help);
  EXPECT_EQ(parse_options({"help", "bench"}).help_topic, Command::bench);
  EXPECT_EQ(parse_options({"bench", "--help"}).help_topic, Command::bench);
  EXPECT_EQ(parse_options({"diff", "--help"}).command, Command::help);
  EXPECT_NE(complaint(Words{"help", "cooking"}), "");
}

}  // namespace
}  // namespace vitral
