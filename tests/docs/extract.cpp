// Writes the C++ of all pages as one file, which a compiler then checks: extract SOURCE_FOLDER OUTPUT.
// A block that declares a class or a function stands in a namespace of its own, one that begins a namespace in none. Any other
// one is the body of a function, with the names that the pages use for bodies, frames and a world.
#include <cstdio>
#include <exception>
#include <set>

#include "pages.h"

namespace {

constexpr const char* kParameters =
    "[[maybe_unused]] btDiscreteDynamicsWorld& world, [[maybe_unused]] btRigidBody& a, "
    "[[maybe_unused]] btRigidBody& b,\n"
    "    [[maybe_unused]] const btTransform& frame_in_a, [[maybe_unused]] const btTransform& "
    "frame_in_b";

struct Code {
  std::set<std::string> includes;
  std::string text;
  int blocks = 0;
};

bool begins(const std::string& line, const char* word) { return line.rfind(word, 0) == 0; }

// Of what stands at the left edge and goes on in the next line.
bool isDeclaration(const std::string& line) {
  if (line.empty() || line.back() == ';') return false;
  for (const char* word : {"class ", "struct ", "namespace ", "template ", "int ", "void "})
    if (begins(line, word)) return true;
  return false;
}

void addBlock(const std::string& place, const std::vector<std::string>& lines, Code& code) {
  std::string body;
  bool declares = false, reopens = false;
  for (const std::string& line : lines) {
    if (begins(line, "#include")) {
      code.includes.insert(line);
      body += "\n";
      continue;
    }
    declares = declares || isDeclaration(line);
    reopens = reopens || begins(line, "namespace ");
    body += line + "\n";
  }
  const std::string name = "block_" + std::to_string(++code.blocks);
  if (!reopens) code.text += "\nnamespace " + name + " {\n";
  if (!declares) code.text += std::string("void example(") + kParameters + ") {\n";
  code.text += "#line " + place + "\n" + body;
  if (!declares) code.text += "}\n";
  if (!reopens) code.text += "}\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s SOURCE_FOLDER OUTPUT\n", argv[0]);
    return 2;
  }
  try {
    Code code;
    for (const auto& page : pages::all(argv[1])) {
      pages::Fence fence;
      std::vector<std::string> block;
      int number = 0, first = 0;
      for (const std::string& line : pages::lines(pages::read(page))) {
        ++number;
        const std::string language = fence.language();
        if (fence.takes(line) && fence.open() && !begins(line, "```")) {
          if (language == "cpp") block.push_back(line);
        } else if (!block.empty()) {
          addBlock(std::to_string(first) + " \"" + page.string() + "\"", block, code);
          block.clear();
        } else {
          first = number + 1;
        }
      }
    }
    std::ofstream file(argv[2]);
    file << "#include <btBulletDynamicsCommon.h>\n";
    for (const std::string& include : code.includes) file << include << "\n";
    file << code.text;
    if (!file.flush() || code.blocks < 15)
      throw std::runtime_error("found " + std::to_string(code.blocks) +
                               " blocks of C++, or cannot write them");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
