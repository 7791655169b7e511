#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// A surface to simplify, and where it comes from.
struct BenchMesh {
  std::string name;
  std::string data_sha256;  ///< of the file or, for made-up volumes, of the surface
  IndexedMesh m0;
  /// (n) with two finite ends of the range: which of the two isovalues a vertex lies nearer to. Else empty.
  std::vector<std::uint8_t> sheet;
};

/// The surface that a specification names: words with colons between them.
///
///   channel:NODES:SEED  reflectors:NODES:SEED  channel or reflectors with holes and a polygon as outline, when
///   followed
///                       by :holes
///   gyroid:NODES        with noise
///   FILE.sgy            a survey
///   FILE.raw:I,J,K      unsigned bytes, inline fastest; FILE.f32:I,J,K float32
///
/// then optionally :range=LOW,HIGH and :open for rims that are not capped.
///
/// errors   invalid_argument: another specification; those of import_volume and extract_body.
Result<BenchMesh> make_bench_mesh(const std::string& specification);

}  // namespace geosis
