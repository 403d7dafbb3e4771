// Particles that sinks take, and bodies that were torn: their parts are groups of their own from the next
// step on.
#include <algorithm>
#include <map>
#include <numeric>

#include "oracle/oracle.h"

namespace mallow::oracle {
namespace {

/// What has fewer particles is no part of its own.
constexpr std::size_t k_crumb = 4;

}  // namespace

// Parts of a group: those that share regions, directly or through others; the largest first, and with it all
// that belongs to none.
std::vector<std::vector<std::size_t>> Oracle::parts_of_group(std::size_t group) const {
  std::vector<std::size_t> part(particles_.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < particles_.size(); ++i)
      for (const std::size_t j : particles_[i].region) {
        if (part[i] == part[j]) continue;
        part[i] = part[j] = std::min(part[i], part[j]);
        changed = true;
      }
  }
  std::map<std::size_t, std::vector<std::size_t>> by_first;
  for (std::size_t i = 0; i < particles_.size(); ++i)
    if (particles_[i].group == group) by_first[part[i]].push_back(i);
  std::vector<std::vector<std::size_t>> parts;
  std::vector<std::size_t> crumbs;
  for (const auto& [first, members] : by_first)
    if (members.size() < k_crumb)
      crumbs.insert(crumbs.end(), members.begin(), members.end());
    else
      parts.push_back(members);
  if (parts.empty()) return {crumbs};
  const auto smaller = [](const auto& a, const auto& b) { return a.size() < b.size(); };
  std::iter_swap(parts.begin(), std::max_element(parts.begin(), parts.end(), smaller));
  parts.front().insert(parts.front().end(), crumbs.begin(), crumbs.end());
  return parts;
}

// Before a step. x̄, rotations, stretches and regions stay, and so does what the group was judged by.
void Oracle::split_torn() {
  const std::size_t groups = groups_.size();
  for (std::size_t g = 0; g < groups; ++g) {
    if (!groups_[g].splits || !groups_[g].may_be_torn) continue;
    groups_[g].may_be_torn = false;
    const std::vector<std::vector<std::size_t>> parts = parts_of_group(g);
    for (std::size_t k = 1; k < parts.size(); ++k) {
      const Group part = groups_[g];
      for (const std::size_t i : parts[k]) particles_[i].group = groups_.size();
      groups_.push_back(part);
    }
  }
}

// Before a step, behind what nozzles let go. Those that are left rest where they did.
void Oracle::drain() {
  const auto is_taken = [&](const Particle& p) {
    return !p.pinned && std::any_of(sinks_.begin(), sinks_.end(), [&](const Sink& sink) {
      const bool inside = (p.x.array() >= sink.box.min.cast<double>().array()).all() &&
                          (p.x.array() <= sink.box.max.cast<double>().array()).all();
      return inside != sink.outside;
    });
  };
  std::vector<std::size_t> place(particles_.size());  // of those that stay
  std::vector<Particle> left;
  std::vector<bool> lost(groups_.size(), false);
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    place[i] = left.size();
    if (is_taken(particles_[i]))
      lost[particles_[i].group] = true;
    else
      left.push_back(particles_[i]);
  }
  if (left.size() == particles_.size()) return;
  particles_ = std::move(left);
  for (Strand& strand : strands_)
    for (std::vector<std::size_t>& layer : strand.held)
      for (std::size_t& held : layer) held = place[held];
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (lost[g]) groups_[g].may_be_torn = true;
  for (std::size_t g = 0; g < groups_.size(); ++g) list_regions(g);
}

}  // namespace mallow::oracle
