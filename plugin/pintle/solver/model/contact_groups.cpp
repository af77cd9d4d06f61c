#include <pintle/solver/model/contact_groups.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {

int ContactGroups::rootOf(int body) {
  int root = body;
  while (m_root[size_t(root)] != root) root = m_root[size_t(root)];
  while (m_root[size_t(body)] != root) body = std::exchange(m_root[size_t(body)], root);
  return root;
}

int ContactGroups::groupOf(const ContactRow& row) const {
  const int body = std::max(row.body[0], row.body[1]);
  return body < 0 ? -1 : m_group[size_t(body)];
}

// In the order of their first bodies.
void ContactGroups::number(const std::vector<ContactRow>& contacts) {
  constexpr int of_none = -1, of_any = -2;
  m_group.assign(m_root.size(), of_none);
  for (const ContactRow& row : contacts)
    for (const int body : row.body)
      if (body >= 0) m_group[size_t(rootOf(body))] = of_any;
  m_ends.clear();
  for (size_t i = 0; i < m_root.size(); ++i) {
    const auto root = size_t(rootOf(int(i)));  // the first one of its group
    if (m_group[root] == of_any) {
      m_group[root] = int(m_ends.size());
      m_ends.emplace_back();
    }
    m_group[i] = m_group[root];
  }
}

// put(i, its place) of `count` elements, group by group, each in the order that it had; those of none come last.
template <class GroupOf, class Put>
void ContactGroups::sort(size_t count, size_t Ends::*end, const GroupOf& groupOfElement,
                         const Put& put) {
  for (size_t i = 0; i < count; ++i)
    if (const int group = groupOfElement(i); group >= 0) ++(m_ends[size_t(group)].*end);
  size_t behind = 0;
  for (Ends& of : m_ends) behind += std::exchange(of.*end, behind);
  for (size_t i = 0; i < count; ++i) {
    const int group = groupOfElement(i);
    put(i, group >= 0 ? (m_ends[size_t(group)].*end)++ : behind++);
  }
}

void ContactGroups::find(const std::vector<Component>& components, size_t bodies,
                         std::vector<ContactRow>& contacts) {
  if (contacts.empty()) {
    m_group.assign(bodies, -1);
    m_ends.clear();
    return;
  }
  m_root.resize(bodies);
  std::iota(m_root.begin(), m_root.end(), 0);
  for (const Component& of : components)
    std::fill_n(m_root.begin() + of.first_body, of.bodies, of.first_body);
  for (const ContactRow& row : contacts) {
    if (row.body[0] < 0 || row.body[1] < 0) continue;
    const int a = rootOf(row.body[0]), b = rootOf(row.body[1]);
    m_root[size_t(std::max(a, b))] = std::min(a, b);
  }
  number(contacts);
  m_components.resize(components.size());
  sort(
      components.size(), &Ends::components,
      [&](size_t i) { return m_group[size_t(components[i].first_body)]; },
      [&](size_t i, size_t place) { m_components[place] = &components[i]; });
  m_bodies.resize(bodies);
  sort(
      bodies, &Ends::bodies, [&](size_t i) { return m_group[i]; },
      [&](size_t i, size_t place) { m_bodies[place] = int(i); });
  const size_t rows = contacts.size();
  m_unsorted.swap(contacts);
  contacts.resize(rows);
  m_place.resize(rows);
  sort(
      rows, &Ends::rows, [&](size_t i) { return groupOf(m_unsorted[i]); },
      [&](size_t i, size_t place) {
        contacts[place] = m_unsorted[i];
        m_place[i] = int(place);
      });
  for (ContactRow& row : contacts)
    if (row.isFriction())
      row.normal = m_place[size_t(row.normal)] - int(firstOf(groupOf(row)).rows);
  m_rows = contacts.data();
}

ContactGroup ContactGroups::operator[](size_t group) const {
  const Ends first = firstOf(int(group)), &end = m_ends[group];
  return {{m_components.data() + first.components, end.components - first.components},
          {m_bodies.data() + first.bodies, end.bodies - first.bodies},
          {m_rows + first.rows, end.rows - first.rows}};
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
