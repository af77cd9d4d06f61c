#include "table.h"

#include <chrono>
#include <cstring>
#include <iterator>

namespace tables {
namespace {

void print(const Column& column, double value) {
  if (std::isinf(value)) {
    std::printf("%9s", column.infinite);
  } else if (std::isnan(value)) {
    std::printf("%9s", "none");
  } else {
    std::printf("%9s", text(column.format, value).c_str());
  }
}

void print_ratio(double ours, double stock) {
  const double ratio = ours / stock;
  if (std::isnan(ratio)) {  // both 0, or both infinite
    std::printf("%7s", "-");
  } else if (ratio != 0 && (ratio < 0.01 || ratio >= 1000)) {
    std::printf("%7.0e", ratio);
  } else {
    std::printf("%7.2f", ratio);
  }
}

}  // namespace

Table::Table(Output& out, const std::string& scene, const std::string& title,
             std::vector<Column> columns)
    : out_(out), scene_(scene), columns_(std::move(columns)) {
  if (out_.plan != nullptr) {
    out_.plan->titles.push_back(title);
    return;
  }
  if (out_.progress != nullptr) out_.progress->clear();
  std::printf("\n%s: %s\n%-22s%-8s", scene.c_str(), title.c_str(), "", "");
  for (const Column& column : columns_) std::printf("%9s", column.quantity.c_str());
  std::printf("%7s%7s\n%-22s%-8s", "error", "time", "case", "who");
  for (const Column& column : columns_) std::printf("%9s", column.unit.c_str());
  std::printf("%7s%7s\n", "/stock", "/stock");
}

void Table::compare(const std::string& name, const std::vector<Contender>& all) {
  std::vector<Contender> contenders;
  std::copy_if(all.begin(), all.end(), std::back_inserter(contenders),
               [&](const Contender& contender) { return out_.shows(contender.who); });
  if (out_.plan != nullptr) {
    for (const Contender& contender : all) out_.plan->contenders.insert(contender.who);
    ++out_.plan->cases;
    return;
  }
  std::vector<Measurement> results;
  for (const Contender& contender : contenders) results.push_back(contender.run());
  if (!out_.once) repeat(name, contenders, results);

  if (out_.progress != nullptr) out_.progress->clear();
  const auto write = [&](const std::string& who, const std::string& quantity,
                         const std::string& unit, double value) {
    const Number number = {scene_, name, who, quantity, unit, value};
    out_.files.write(number);
    out_.brief.note(number);
  };
  const Measurement* stock = nullptr;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const std::string& who = contenders[i].who;
    std::printf("%-22s%-8s", i == 0 ? name.c_str() : "", who.c_str());
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const double value = results[i].values[c];
      print(columns_[c], value);
      write(who, columns_[c].quantity, columns_[c].unit, value);
    }
    if (stock != nullptr) {
      print_ratio(results[i].error, stock->error);
      print_ratio(results[i].microseconds_per_step, stock->microseconds_per_step);
      write(who, "time", "stock=1",
            results[i].microseconds_per_step / stock->microseconds_per_step);
    } else if (who.rfind("stock", 0) == 0) {
      stock = &results[i];
    }
    std::printf("\n");
  }
  std::fflush(stdout);
  if (out_.progress != nullptr) out_.progress->advance(1, scene_ + ", after " + name);
}

void Table::repeat(const std::string& name, const std::vector<Contender>& contenders,
                   std::vector<Measurement>& results) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  for (int turn = 0; turn < 100; ++turn) {
    if (turn >= 2 && Clock::now() - start > std::chrono::milliseconds(250)) break;
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      if (results[i].microseconds_per_step == 0) continue;
      const Measurement again = contenders[i].run();
      results[i].microseconds_per_step =
          std::min(results[i].microseconds_per_step, again.microseconds_per_step);
      // Bit by bit, so that NaN equals NaN.
      if (std::memcmp(again.values.data(), results[i].values.data(),
                      again.values.size() * sizeof(double)) != 0) {
        if (out_.progress != nullptr) out_.progress->clear();
        std::fprintf(stderr, "%s, %s, %s: a second run gave other numbers\n", scene_.c_str(),
                     name.c_str(), contenders[i].who.c_str());
        out_.all_repeated = false;
      }
    }
  }
}

}  // namespace tables
