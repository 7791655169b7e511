#include "engine/isosurface/node_runs.h"

#include "engine/isosurface/contacts.h"

namespace geosis {

NodeRuns::NodeRuns(const BrickField& field)
    : field_(field), rows_(static_cast<std::size_t>(kBrickSamples) * kBrickSamples) {}

void NodeRuns::find(std::int32_t first) {
  first_ = next_ = first;
  contact_element_.clear();
  const LocalBox& box = field_.box();
  for (int a = box.first[0]; a <= box.last[0]; ++a) {
    for (int b = box.first[1]; b <= box.last[1]; ++b) find_row(a, b);
  }
}

void NodeRuns::find_row(int a, int b) {
  Row& row = rows_[at(a, b)];
  row = {.plain = field_.inside(a, b) & field_.nodes_in_region()};
  if (row.plain == 0) return;
  const CellPresence& presence = field_.presence();
  if (!presence.is_complete()) {
    row.plain &= presence.nodes_of_cells(a, b);
    each_bit(row.plain & ~presence.surrounded_nodes(a, b), [&](int c) {
      const bool is_contact = contact::cell_groups(presence.around_node(a, b, c)).count > 1;
      row.contacts |= std::uint64_t{is_contact} << c;
    });
    row.plain &= ~row.contacts;
  }
  const std::uint64_t joined = row.plain & row.plain >> 1 & present_edges(2, a, b);
  row.starts = row.plain & ~(joined << 1);
  row.first_run = next_;
  next_ += std::popcount(row.starts);
  row.first_contact = static_cast<std::int32_t>(contact_element_.size());
  each_bit(row.contacts, [&](int c) {
    contact_element_.push_back(next_);
    next_ += contact::cell_groups(presence.around_node(a, b, c)).count;
  });
}

std::uint64_t NodeRuns::present_edges(int axis, int a, int b) const {
  return field_.presence().is_complete() ? ~std::uint64_t{0} : field_.presence().edges_of_cells(axis, a, b);
}

void NodeRuns::join(DisjointSets& sets) const {
  const LocalBox& box = field_.box();
  for (int a = box.first[0]; a <= box.last[0]; ++a) {
    for (int b = box.first[1]; b <= box.last[1]; ++b) {
      if (nodes(a, b) == 0) continue;
      if (contacts(a, b) != 0) join_row(a, b, sets);
      if (b < box.last[1]) join_rows(1, a, b, sets);
      if (a < box.last[0]) join_rows(0, a, b, sets);
    }
  }
}

/// Along the row only what a contact is an end of: the rest is in one run already.
void NodeRuns::join_row(int a, int b, DisjointSets& sets) const {
  const std::uint64_t here = nodes(a, b), contact = contacts(a, b);
  each_bit(here & here >> 1 & (contact | contact >> 1) & present_edges(2, a, b),
           [&](int c) { join_edge(2, a, b, c, sets); });
}

/// Row (a, b) and the next along the axis: once for each stretch of edges that joins the same two runs.
void NodeRuns::join_rows(int axis, int a, int b, DisjointSets& sets) const {
  const Row &here = row(a, b), &there = row(a + (axis == 0), b + (axis == 1));
  std::uint64_t edges = (here.plain | here.contacts) & (there.plain | there.contacts);
  if (edges == 0) return;
  edges &= present_edges(axis, a, b);
  const std::uint64_t contact = edges & (here.contacts | there.contacts), plain = edges & ~contact;
  each_bit(plain & (~(plain << 1) | here.starts | there.starts),
           [&](int c) { sets.unite(run(here, c), run(there, c)); });
  each_bit(contact, [&](int c) { join_edge(axis, a, b, c, sets); });
}

void NodeRuns::join_edge(int axis, int a, int b, int c, DisjointSets& sets) const {
  const unsigned around = field_.presence().around_edge(axis, a, b, c);
  const int copies = contact::is_edge_contact(around) ? 2 : 1;
  for (int copy = 0; copy < copies; ++copy) {
    const int place = contact::edge_place(around, copy);
    sets.unite(element(a, b, c, octant_at_start(axis, place)),
               element(a + (axis == 0), b + (axis == 1), c + (axis == 2), octant_at_end(axis, place)));
  }
}

std::int32_t NodeRuns::element(int a, int b, int c, int octant) const {
  const bool is_contact = (contacts(a, b) >> c) & 1;
  if (!is_contact) return run(row(a, b), c);
  return element(a, b, c) + contact::cell_groups(field_.presence().around_node(a, b, c)).group[octant];
}

std::int32_t NodeRuns::element(int a, int b, int c) const {
  const Row& row = this->row(a, b);
  if (((row.contacts >> c) & 1) == 0) return run(row, c);
  return contact_element_[row.first_contact + std::popcount(row.contacts & up_to(c)) - 1];
}

}  // namespace geosis
