// What contacts join.
#include <pintle/solver/model/contact_groups.h>

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace exact_contact_groups_test {

using pintle::Component;
using pintle::ContactGroup;
using pintle::ContactGroups;
using pintle::ContactRow;

Component component(int first_body, int bodies) {
  Component of;
  of.first_body = first_body;
  of.bodies = bodies;
  return of;
}

// A contact and its friction, which is told by its coefficient.
void touch(std::vector<ContactRow>& rows, std::array<int, 2> bodies, double friction) {
  ContactRow row;
  row.body = bodies;
  row.friction = -friction;
  rows.push_back(row);
  row.friction = friction;
  row.normal = int(rows.size()) - 1;
  rows.push_back(row);
}

std::vector<int> bodiesOf(const ContactGroup& group) {
  return {group.bodies.begin(), group.bodies.end()};
}

// Bodies 0 to 2 and 3 to 4 are components, and 5 to 8 have no joints.
TEST(ContactGroups, AreWhatContactsJoin) {
  const std::vector<Component> components = {component(0, 3), component(3, 2)};
  std::vector<ContactRow> rows;
  touch(rows, {-1, -1}, 1);
  touch(rows, {7, -1}, 2);
  touch(rows, {8, 1}, 3);
  touch(rows, {5, 7}, 4);
  touch(rows, {-1, 0}, 5);
  ContactGroups groups;
  groups.find(components, 9, rows);
  EXPECT_TRUE(groups.has(components[0]));
  EXPECT_FALSE(groups.has(components[1]));
  ASSERT_EQ(groups.count(), 2u);
  EXPECT_EQ(bodiesOf(groups[0]), (std::vector<int>{0, 1, 2, 8}));
  EXPECT_EQ(bodiesOf(groups[1]), (std::vector<int>{5, 7}));
  ASSERT_EQ(groups[0].components.size(), 1u);
  EXPECT_EQ(groups[0].components[0], &components[0]);
  EXPECT_TRUE(groups[1].components.empty());
  const std::vector<double> frictions[] = {{3, 5}, {2, 4}};
  for (size_t g = 0; g < 2; ++g) {
    const ContactGroup group = groups[g];
    ASSERT_EQ(group.rows.size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
      const ContactRow& row = group.rows[i];
      EXPECT_EQ(std::abs(row.friction), frictions[g][i / 2]);
      EXPECT_EQ(row.isFriction(), i % 2 == 1);
      EXPECT_EQ(row.normal, row.isFriction() ? int(i) - 1 : -1);
    }
  }
  EXPECT_EQ(rows[8].friction, -1) << "that of bodies that do not move comes last";
}

TEST(ContactGroups, AreNoneWithoutContacts) {
  const std::vector<Component> components = {component(0, 3)};
  std::vector<ContactRow> rows;
  ContactGroups groups;
  groups.find(components, 3, rows);
  EXPECT_EQ(groups.count(), 0u);
  EXPECT_FALSE(groups.has(components[0]));
}

}  // namespace exact_contact_groups_test
