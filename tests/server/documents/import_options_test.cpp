#include "server/documents/import_options.h"

#include <string>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

std::string refusal(const char* name, const char* text) {
  ImportOptions options;
  const auto set = set_import_option(options, name, text);
  return set ? "" : set.error().message;
}

TEST(SetImportOption, ReadsRawOptions) {
  ImportOptions options;
  for (const auto& [name, text] : {std::pair{"format", "raw"},
                                   {"dims", "64,33,32"},
                                   {"dtype", "uint16"},
                                   {"order", "inline"},
                                   {"byte_order", "big"},
                                   {"origin", "1e6,-2.5,0"},
                                   {"spacing", "1,1,0.5"},
                                   {"null_value", "-999.25"}}) {
    EXPECT_TRUE(set_import_option(options, name, text)) << name;
  }
  EXPECT_EQ(options.format, FileFormat::raw);
  EXPECT_EQ(options.dims, (GridShape{64, 33, 32}));
  EXPECT_EQ(options.dtype, SampleType::uint16);
  EXPECT_EQ(options.order, RawOrder::inline_fastest);
  EXPECT_EQ(options.byte_order, ByteOrder::big);
  EXPECT_EQ(options.origin, (Vec3d{1e6, -2.5, 0}));
  EXPECT_EQ(options.spacing, (Vec3d{1, 1, 0.5}));
  EXPECT_EQ(options.null_value, -999.25);
}

TEST(SetImportOption, ReadsSegyOptions) {
  ImportOptions options;
  for (const auto& [name, text] : {std::pair{"inline_byte", "189"},
                                   {"crossline_byte", "193"},
                                   {"inline_width", "2"},
                                   {"x_byte", "181"},
                                   {"coordinate_scalar", "-100"},
                                   {"sample_format", "5"},
                                   {"duplicates", "mean"},
                                   {"zero_traces", "missing"}}) {
    EXPECT_TRUE(set_import_option(options, name, text)) << name;
  }
  EXPECT_EQ(options.inline_byte, 189);
  EXPECT_EQ(options.crossline_byte, 193);
  EXPECT_EQ(options.inline_width, 2);
  EXPECT_EQ(options.x_byte, 181);
  EXPECT_EQ(options.coordinate_scalar, -100);
  EXPECT_EQ(options.sample_format, 5);
  EXPECT_EQ(options.duplicates, DuplicateTraces::mean);
  EXPECT_EQ(options.zero_traces, ZeroTraces::missing);
}

TEST(SetImportOption, RefusesTextThatItDoesNotTake) {
  EXPECT_EQ(refusal("dims", "64,33"), "import option dims: \"64,33\"; expected I,J,K");
  for (const auto& [name, text] : {std::pair{"dims", "1,2,3,4"},
                                   {"dims", "0,1,1"},
                                   {"dims", "1,2,"},
                                   {"dims", "3000000000,1,1"},
                                   {"dims", ""},
                                   {"inline_byte", "0"},
                                   {"inline_byte", "241"},
                                   {"inline_width", "3"},
                                   {"inline_byte", "189x"},
                                   {"null_value", "nan"},
                                   {"origin", "inf,0,0"},
                                   {"format", "sgy"},
                                   {"sample_format", "17"}}) {
    EXPECT_NE(refusal(name, text), "") << name << " " << text;
  }
  EXPECT_EQ(refusal("colour", "1"), "import option colour: there is no such option");
}

TEST(SetImportOption, KnowsEveryNameItLists) {
  for (const auto& option : import_option_names()) {
    EXPECT_EQ(refusal(option.name, "\n").find("there is no such option"), std::string::npos) << option.name;
  }
}

TEST(ImportOptionsDocument, HoldsOnlyWhatTheFormatHas) {
  ImportOptions options;
  options.format = FileFormat::raw;
  options.dims = GridShape{2, 3, 4};
  EXPECT_EQ(
      canonical_text(import_options_document(options)),
      R"({"byte_order":"auto","dims":[2,3,4],"dtype":"float32","format":"raw","null_value":null,"order":"sample",)"
      R"("origin":[0,0,0],"spacing":[1,1,1]})");
  options.format = FileFormat::segy;
  EXPECT_EQ(canonical_text(import_options_document(options)),
            R"({"byte_order":"auto","coordinate_scalar":null,"crossline_byte":null,"crossline_width":4,)"
            R"("duplicates":"reject","format":"segy","inline_byte":null,"inline_width":4,"null_value":null,)"
            R"("sample_format":null,"x_byte":null,"y_byte":null,"zero_traces":"keep"})");
}

}  // namespace
}  // namespace geosis::server
