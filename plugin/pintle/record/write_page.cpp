#include <pintle/record.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {

constexpr char marker[] = "<!-- pintle: runs -->";

// As the header says; `known` is that of CMake's target.
std::string pageTemplate(const std::string& given, const std::string& known) {
  const char* const named = std::getenv("PINTLE_PAGE_TEMPLATE");
  const std::string path = !given.empty()                    ? given
                           : named != nullptr && *named != 0 ? std::string(named)
                                                             : known;
  if (path.empty())
    throw std::runtime_error(
        "Recorder: no template of the page is known; name one, or set PINTLE_PAGE_TEMPLATE to its "
        "path");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file)
    throw std::runtime_error("Recorder: the page's template " + path +
                             " can't be read; build it with Node (demos/page/build.sh), or set "
                             "PINTLE_PAGE_TEMPLATE to its path");
  return text.str();
}

}  // namespace record

void writePageWith(const std::string& path, const Recordings& recordings,
                   const std::string& page_template, const std::string& known_template) {
  if (recordings.empty()) throw std::invalid_argument("writePage: no recording is given");
  const std::string page = record::pageTemplate(page_template, known_template);
  const std::size_t place = page.find(record::marker);
  if (place == std::string::npos)
    throw std::runtime_error(std::string("writePage: the template has no place for runs, ") +
                             record::marker);

  std::ofstream file(path, std::ios::binary);
  file << page.substr(0, place);
  for (const Recorder& recorder : recordings)
    file << "<script type=\"application/json\" class=\"pintle-run\">" << recorder.toJson()
         << "</script>\n";
  file << page.substr(place + sizeof record::marker - 1);
  file.close();
  if (!file) throw std::runtime_error("writePage: " + path + " can't be written");
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
