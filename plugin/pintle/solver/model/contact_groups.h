// Purpose: what contacts join, of all that Bullet hands over at once: components of joints, and bodies without any. One group says
// nothing of the others: each is solved alone, and is done when it is.
#pragma once

#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/model/contacts.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct ContactGroup {
  Span<const Component* const> components;
  Span<const int> bodies;  ///< of the island: those of the components, and others
  Span<ContactRow> rows;   ///< their `normal` is counted from the first one of them
};

class ContactGroups {
 public:
  /// Puts rows of a group side by side. Those between bodies that do not move are in none, and come last.
  void find(const std::vector<Component>& components, size_t bodies,
            std::vector<ContactRow>& contacts);
  size_t count() const { return m_ends.size(); }
  ContactGroup operator[](size_t group) const;
  /// Whether a contact is on one of its bodies.
  bool has(const Component& component) const { return m_group[size_t(component.first_body)] >= 0; }

  void reserve(size_t bodies, size_t components) {
    pintle::reserve(bodies, m_root, m_group, m_bodies, m_ends);
    pintle::reserve(components, m_components);
  }
  size_t bytes() const {
    return bytesOf(m_root, m_group, m_components, m_bodies, m_unsorted, m_place, m_ends);
  }

 private:
  struct Ends {
    size_t components = 0, bodies = 0, rows = 0;
  };

  int rootOf(int body);
  int groupOf(const ContactRow& row) const;
  void number(const std::vector<ContactRow>& contacts);
  template <class GroupOf, class Put>
  void sort(size_t count, size_t Ends::*end, const GroupOf& groupOfElement, const Put& put);
  Ends firstOf(int group) const { return group > 0 ? m_ends[size_t(group) - 1] : Ends(); }

  std::vector<int>
      m_root;  ///< of each body: an earlier one that it is joined with; of the first one: itself
  std::vector<int> m_group;  ///< of each body; -1: no contact is on what it is joined with
  std::vector<const Component*> m_components;  ///< group by group
  std::vector<int> m_bodies;
  ContactRow* m_rows = nullptr;
  std::vector<ContactRow> m_unsorted;  ///< memory
  std::vector<int> m_place;            ///< of each row: after it was sorted
  std::vector<Ends> m_ends;            ///< of each group
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
