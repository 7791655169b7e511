// geosis_generate_mc33 TABLES REPORT: writes engine/isosurface/mc33_tables.cpp and docs/mc33-cases.md. Enumerates every
// state of a cell, triangulates and proves each, and lays them out for the mesher. A test writes both files again and
// compares.
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "engine/isosurface/generator/proven_states.h"
#include "engine/isosurface/generator/write_report.h"
#include "engine/isosurface/generator/write_tables.h"

namespace {

void write_file(const char* path, const std::string& text) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path, "w"), std::fclose);
  if (file && std::fwrite(text.data(), 1, text.size(), file.get()) == text.size()) return;
  std::fprintf(stderr, "%s cannot be written\n", path);
  std::exit(1);
}

}  // namespace

int main(int count, char** arguments) {
  using namespace geosis::generator;
  if (count != 3) {
    std::fprintf(stderr, "usage: geosis_generate_mc33 TABLES REPORT\n");
    return 2;
  }
  const auto states = prove_states();
  write_file(arguments[1], tables_text(states));
  write_file(arguments[2], report_text(states));
}
