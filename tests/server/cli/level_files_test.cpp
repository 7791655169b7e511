#include "server/cli/level_files.h"

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

TEST(FileUrls, NumberPartsOnlyWhenThereAreSeveral) {
  const auto urls = file_urls();
  EXPECT_EQ(urls.level(3, 1), "lod3.drc");
  EXPECT_EQ(urls.part(3, 0, 1), "lod3.drc");
  EXPECT_EQ(urls.level(0, 4), std::nullopt);
  EXPECT_EQ(urls.part(0, 3, 4), "lod0.3.drc");
}

TEST(IsResultFile, KnowsItsOwnNamesAndNoOthers) {
  for (const char* name :
       {"manifest.json", "lod0.drc", "lod12.3.drc", "lod4.ply", "lod0.obj", "lod1.glb", "lod2.stl"}) {
    EXPECT_TRUE(is_result_file(name)) << name;
  }
  for (const char* name : {"lod.drc", "lod0.drc.bak", "my-lod0.drc", "lod0.1.ply", "notes.txt", "manifestxjson", ""}) {
    EXPECT_FALSE(is_result_file(name)) << name;
  }
}

TEST(ParseFileFormats, ReadsTheList) {
  EXPECT_FALSE(parse_file_formats("drc").value().ply);
  EXPECT_TRUE(parse_file_formats("drc,ply").value().ply);
  EXPECT_TRUE(parse_file_formats("obj,drc").value().obj);
  EXPECT_TRUE(parse_file_formats("glb,stl").value().glb);
  EXPECT_TRUE(parse_file_formats("glb,stl").value().stl);
}

TEST(ParseFileFormats, RefusesOthers) {
  for (const char* text : {"gltf", "drc,,ply", "drc ply", "PLY"}) EXPECT_FALSE(parse_file_formats(text)) << text;
}

}  // namespace
}  // namespace geosis::server
