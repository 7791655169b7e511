#include "engine/volume/formats/text_header.h"

#include <string>

#include <gtest/gtest.h>

namespace geosis {
namespace {

std::string decode(const std::string& block) {
  return decode_text_header(std::as_bytes(std::span(block)));
}

TEST(TextHeader, ComesBackFromEbcdic) {
  const std::string text = "C 1 CLIENT: ~!@#$%^&*()_+{}|:\"<>?`-=[]\\;',./\n\nC 3 abcXYZ0189";
  const auto block = encode_text_header(text);
  ASSERT_TRUE(block) << block.error().message;
  EXPECT_EQ(block->size(), kTextBytes);
  EXPECT_EQ(static_cast<unsigned char>((*block)[0]), 0xc3);  // 'C'
  EXPECT_EQ(decode(*block), text);
}

TEST(TextHeader, HasBracketsWhereEitherCodePageHasThem) {
  std::string block(kTextBytes, '\x40');
  block.replace(0, 9, "\xc3\x40\xf1\x40\xad\xd9\xbd\xba\xbb");
  EXPECT_EQ(decode(block), "C 1 [R][]");
}

TEST(TextHeader, ReadsAsciiAndBlanksControlCharacters) {
  std::string block(kTextBytes, ' ');
  block.replace(0, 3, "C 1");
  block.replace(80, 4, std::string("a\0b\x01", 4));
  EXPECT_EQ(decode(block), "C 1\na b");
}

TEST(TextHeader, IsValidUtf8WhateverTheBytes) {
  std::string block;
  for (std::size_t b = 0; b < kTextBytes; ++b) block += static_cast<char>(b);
  const std::string text = decode(block);
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto lead = static_cast<unsigned char>(text[at]);
    if (lead < 0x80) continue;
    EXPECT_TRUE(lead == 0xc2 || lead == 0xc3);
    EXPECT_EQ(static_cast<unsigned char>(text.at(++at)) & 0xc0, 0x80);
  }
}

TEST(TextHeader, RefusesWhatDoesNotFit) {
  EXPECT_TRUE(encode_text_header(std::string(80, 'x')));
  EXPECT_EQ(encode_text_header(std::string(81, 'x')).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(encode_text_header(std::string(40, '\n') + "x").error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(encode_text_header("\t").error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(encode_text_header("\xc3\xa4").error().code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace geosis
