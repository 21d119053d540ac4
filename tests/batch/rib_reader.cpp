#include "batch/rib_reader.hpp"

#include <charconv>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <regex>
#include <stdexcept>
#include <variant>

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

using Numbers = std::vector<double>;
using Strings = std::vector<std::string>;
using Value = std::variant<double, std::string, Numbers, Strings>;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": no such file");
  return {std::istreambuf_iterator<char>(in), {}};
}

// Numbers, strings, arrays of one kind and requests.
class Lexer {
 public:
  explicit Lexer(const fs::path& file) : file_(file), text_(text_of(file)) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(file_.string() + ":" + std::to_string(line_) + ": " + what);
  }
  bool at_end() {
    skip();
    return at_ == text_.size();
  }
  bool at_request() {
    skip();
    return at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_]));
  }
  std::string request() {
    if (!at_request()) fail("expected a request");
    const std::size_t first = at_;
    while (at_ < text_.size() && std::isalnum(static_cast<unsigned char>(text_[at_]))) ++at_;
    return text_.substr(first, at_ - first);
  }
  Value value() {
    skip();
    if (at_ == text_.size()) fail("expected a value, found the end");
    if (text_[at_] == '"') return string();
    if (text_[at_] != '[') return number();
    ++at_;
    Numbers numbers;
    Strings strings;
    for (skip(); at_ < text_.size() && text_[at_] != ']'; skip())
      if (text_[at_] == '"')
        strings.push_back(string());
      else
        numbers.push_back(number());
    if (at_ == text_.size()) fail("expected ], found the end");
    ++at_;
    if (!numbers.empty() && !strings.empty()) fail("an array of numbers and strings");
    return strings.empty() ? Value(numbers) : Value(strings);
  }

 private:
  void skip() {
    while (at_ < text_.size()) {
      if (text_[at_] == '#')
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      else if (!std::isspace(static_cast<unsigned char>(text_[at_])))
        return;
      else if (text_[at_++] == '\n')
        ++line_;
    }
  }
  std::string string() {
    std::string out;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
      if (at_ == text_.size() || text_[at_] == '\n') fail("a string without an end");
      out += text_[at_];
    }
    if (at_ == text_.size()) fail("a string without an end");
    ++at_;
    return out;
  }
  double number() {
    double value = 0;
    const auto [end, code] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (code != std::errc()) fail("expected a number, found '" + text_.substr(at_, 10) + "'");
    at_ = static_cast<std::size_t>(end - text_.data());
    if (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_])) && text_[at_] != ']')
      fail("a number that goes on");
    return value;
  }

  fs::path file_;
  std::string text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

// What a request takes before its parameter list: s string, n number, a array of numbers, p parameter list.
const std::map<std::string, std::string> kRequests = {
    {"version", "n"},     {"Option", "sp"},         {"MakeTexture", "sssssnn"},
    {"FrameBegin", "n"},  {"FrameEnd", ""},         {"Display", "sssp"},
    {"Format", "nnn"},    {"PixelSamples", "nn"},   {"Exposure", "nn"},
    {"Projection", "sp"}, {"ScreenWindow", "nnnn"}, {"Clipping", "nn"},
    {"Identity", ""},     {"ConcatTransform", "a"}, {"WorldBegin", ""},
    {"WorldEnd", ""},     {"ReadArchive", "s"},     {"TransformBegin", ""},
    {"TransformEnd", ""}, {"AttributeBegin", ""},   {"AttributeEnd", ""},
    {"Attribute", "sp"},  {"LightSource", "snp"},   {"Sides", "n"},
    {"Surface", "sp"},    {"GeneralPolygon", "ap"}, {"Points", "p"},
    {"Sphere", "nnnnp"},  {"Translate", "nnn"}};

class Reader {
 public:
  explicit Reader(const fs::path& file) : folder_(file.parent_path()) {
    read(file);
    if (!blocks_.empty()) throw std::runtime_error(file.string() + ": " + blocks_.back() + " without an end");
  }
  RibFile take() { return std::move(out_); }

 private:
  using Parameters = std::map<std::string, Value>;  // by "type name"

  void read(const fs::path& file) {
    Lexer lexer(file);
    while (!lexer.at_end()) {
      const std::string request = lexer.request();
      const auto known = kRequests.find(request);
      if (known == kRequests.end()) lexer.fail("unknown request " + request);
      strings_.clear();
      numbers_.clear();
      array_.clear();
      parameters_.clear();
      for (const char kind : known->second) argument(lexer, kind);
      if (!lexer.at_end() && !lexer.at_request()) lexer.fail(request + ": more arguments than it takes");
      obey(lexer, request);
    }
  }

  void argument(Lexer& lexer, char kind) {
    if (kind == 'p') {
      while (!lexer.at_end() && !lexer.at_request()) {
        const Value name = lexer.value();
        if (!std::holds_alternative<std::string>(name)) lexer.fail("expected a parameter's name");
        if (!parameters_.emplace(std::get<std::string>(name), lexer.value()).second)
          lexer.fail("a parameter twice");
      }
      return;
    }
    const Value value = lexer.value();
    if (kind == 's' && std::holds_alternative<std::string>(value))
      strings_.push_back(std::get<std::string>(value));
    else if (kind == 'n' && std::holds_alternative<double>(value))
      numbers_.push_back(std::get<double>(value));
    else if (kind == 'a' && std::holds_alternative<Numbers>(value))
      array_ = std::get<Numbers>(value);
    else
      lexer.fail("an argument of the wrong kind");
  }

  void obey(Lexer& lexer, const std::string& request) {
    if (request.ends_with("Begin")) return begin(lexer, request);
    if (request.ends_with("End")) return end(lexer, request);
    if (request == "MakeTexture") {
      need(lexer, strings_[0]);
      made_.insert(strings_[1]);
    } else if (request == "Format") {
      frame(lexer).width = static_cast<int>(numbers_[0]);
      frame(lexer).height = static_cast<int>(numbers_[1]);
    } else if (request == "Projection") {
      if (strings_[0] != "perspective" || only_number(lexer, "float fov") != 90) lexer.fail("not fov 90");
    } else if (request == "ScreenWindow") {
      auto& f = frame(lexer);
      f.left = numbers_[0], f.right = numbers_[1], f.bottom = numbers_[2], f.top = numbers_[3];
    } else if (request == "Identity") {
      transform_.setIdentity();
    } else if (request == "ConcatTransform") {
      if (array_.size() != 16) lexer.fail("expected 16 numbers");
      transform_ = transform_ * Eigen::Map<const RibFile::Matrix>(array_.data());
    } else if (request == "Translate") {
      transform_ =
          transform_ * Eigen::Affine3d(Eigen::Translation3d(numbers_[0], numbers_[1], numbers_[2])).matrix();
    } else if (request == "ReadArchive") {
      need(lexer, strings_[0]);
      read(folder_ / strings_[0]);
    } else if (request == "LightSource") {
      light(lexer);
    } else if (request == "Surface") {
      shader(lexer, "surface", strings_[0]);
      out_.surface = strings_[0];
      for (const auto& [name, value] : parameters_)
        out_.surface_numbers[name.substr(name.find(' ') + 1)] = std::get<Numbers>(value).at(0);
    } else if (request == "Attribute") {
      if (strings_[0] == "identifier") name_ = std::get<Strings>(parameters_.at("string name")).at(0);
    } else if (request == "GeneralPolygon") {
      polygon(lexer);
    } else if (request == "Points") {
      points(lexer);
    } else if (request == "Sphere") {
      if (numbers_[0] != numbers_[2] || numbers_[1] != -numbers_[0] || numbers_[3] != 360)
        lexer.fail("not a whole sphere");
      ball(lexer, Vec3::Zero(), numbers_[0]);
    }
  }

  void begin(Lexer& lexer, const std::string& request) {
    if (request == "FrameBegin") {
      if (!blocks_.empty()) lexer.fail("FrameBegin inside a block");
      out_.frames.emplace_back();
      transform_.setIdentity();
    }
    if (request == "WorldBegin") {
      if (blocks_ != Strings{"Frame"}) lexer.fail("WorldBegin outside a frame");
      out_.frames.back().camera_from_world = transform_;
      transform_.setIdentity();
    }
    stack_.push_back(transform_);
    blocks_.push_back(request.substr(0, request.size() - 5));
  }

  void end(Lexer& lexer, const std::string& request) {
    if (blocks_.empty() || blocks_.back() != request.substr(0, request.size() - 3))
      lexer.fail(request + " without its beginning");
    transform_ = stack_.back();
    stack_.pop_back();
    blocks_.pop_back();
  }

  RibFile::Frame& frame(Lexer& lexer) {
    if (blocks_ != Strings{"Frame"}) lexer.fail("an option outside a frame");
    return out_.frames.back();
  }
  bool first_world(Lexer& lexer) const {
    if (blocks_.size() < 2 || blocks_[1] != "World") lexer.fail("outside the world");
    return out_.frames.size() == 1;
  }
  double only_number(Lexer& lexer, const std::string& name) const {
    const auto found = parameters_.find(name);
    if (found == parameters_.end()) lexer.fail("no " + name);
    const auto* numbers = std::get_if<Numbers>(&found->second);
    if (!numbers || numbers->size() != 1) lexer.fail(name + ": expected one number");
    return numbers->front();
  }
  const Numbers& numbers(Lexer& lexer, const std::string& name) const {
    const auto found = parameters_.find(name);
    if (found == parameters_.end() || !std::holds_alternative<Numbers>(found->second))
      lexer.fail("no " + name);
    return std::get<Numbers>(found->second);
  }

  void need(Lexer& lexer, const std::string& name) {
    if (!fs::is_regular_file(folder_ / name)) lexer.fail("no file " + name);
    out_.files.insert(name);
  }

  // The shader's source is there, of that kind, and declares every parameter with that type.
  void shader(Lexer& lexer, const std::string& kind, const std::string& name) {
    need(lexer, name + ".sl");
    std::string source =
        std::regex_replace(text_of(folder_ / (name + ".sl")), std::regex("/\\*[^]*?\\*/"), "");
    std::smatch head;
    if (!std::regex_search(source, head, std::regex("\\b" + kind + "\\s+" + name + "\\(([^]*?)\\)\\s*\\{")))
      lexer.fail(name + ".sl has no " + kind + " of that name");
    std::set<std::string> declared;
    const std::string list = head[1];
    const std::regex group("(float|string|output varying float)\\s+([^;]*);");
    for (std::sregex_iterator it(list.begin(), list.end(), group), none; it != none; ++it) {
      const std::string names = (*it)[2];
      const std::regex one("([A-Za-z_0-9]+)\\s*=");
      for (std::sregex_iterator at(names.begin(), names.end(), one); at != none; ++at)
        declared.insert((*it)[1].str() + " " + (*at)[1].str());
    }
    for (const auto& [parameter, value] : parameters_)
      if (!declared.count(parameter)) lexer.fail(name + ".sl has no parameter " + parameter);
  }

  void light(Lexer& lexer) {
    if (!first_world(lexer)) return;
    shader(lexer, "light", strings_[0]);
    RibFile::Light light;
    light.shader = strings_[0];
    light.world_from_light = transform_;
    for (const auto& [name, value] : parameters_) {
      const std::string key = name.substr(name.find(' ') + 1);
      if (const auto* list = std::get_if<Numbers>(&value))
        light.numbers[key] = list->at(0);
      else
        light.strings[key] = std::get<Strings>(value).at(0);
    }
    for (const auto& [key, file] : light.strings)
      if (!file.empty() && !made_.count(file)) lexer.fail("texture " + file + " was never made");
    out_.lights.push_back(std::move(light));
  }

  Vec3 world(const Vec3& p) const { return (transform_ * p.homogeneous()).head<3>(); }
  std::vector<Vec3> positions(Lexer& lexer) const {
    const Numbers& flat = numbers(lexer, "P");
    if (flat.size() % 3) lexer.fail("P: not a multiple of three");
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < flat.size(); i += 3)
      points.push_back(world({flat[i], flat[i + 1], flat[i + 2]}));
    return points;
  }

  void polygon(Lexer& lexer) {
    const auto points = positions(lexer);
    RibFile::Polygon polygon{name_, {}};
    std::size_t next = 0;
    for (const double count : array_) {
      if (count < 3 || next + static_cast<std::size_t>(count) > points.size())
        lexer.fail("vertices do not add up");
      const auto first = points.begin() + static_cast<std::ptrdiff_t>(next);
      polygon.rings.emplace_back(first, first + static_cast<std::ptrdiff_t>(count));
      next += static_cast<std::size_t>(count);
    }
    if (next != points.size()) lexer.fail("vertices do not add up");
    if (first_world(lexer)) out_.polygons.push_back(std::move(polygon));
  }

  void ball(Lexer& lexer, const Vec3& centre, double radius) {
    if (!(radius > 0)) lexer.fail("no radius");
    if (first_world(lexer)) out_.balls.push_back({world(centre), radius});
  }

  void points(Lexer& lexer) {
    const auto centres = positions(lexer);
    const Numbers& widths = numbers(lexer, "varying float width");
    if (widths.size() != centres.size()) lexer.fail("widths and points differ in number");
    for (std::size_t i = 0; i < centres.size(); ++i)
      if (first_world(lexer)) out_.balls.push_back({centres[i], widths[i] / 2});
  }

  fs::path folder_;
  RibFile out_;
  Strings blocks_, strings_;
  Numbers numbers_, array_;
  Parameters parameters_;
  std::set<std::string> made_;
  std::string name_;
  RibFile::Matrix transform_ = RibFile::Matrix::Identity();
  std::vector<RibFile::Matrix> stack_;
};

// Where a ray meets a polygon with holes: its plane, then crossings counted in it.
std::optional<double> meet(const RibFile::Polygon& polygon, const Vec3& from, const Vec3& ray) {
  const auto& outer = polygon.rings[0];
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < outer.size(); ++i)
    normal += (outer[i] - outer[0]).cross(outer[i + 1] - outer[0]);
  const double along = normal.dot(ray);
  if (along == 0) return std::nullopt;
  const double distance = normal.dot(outer[0] - from) / along;
  if (!(distance > 0)) return std::nullopt;
  const Vec3 u = normal.unitOrthogonal(), v = normal.normalized().cross(u), hit = from + distance * ray;
  bool inside = false;
  for (const auto& ring : polygon.rings)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec3 a = ring[i] - hit, b = ring[(i + 1) % ring.size()] - hit;
      const double ay = a.dot(v), by = b.dot(v);
      if ((ay > 0) == (by > 0)) continue;
      if (a.dot(u) + ay / (ay - by) * (b.dot(u) - a.dot(u)) > 0) inside = !inside;
    }
  return inside ? std::optional(distance) : std::nullopt;
}

std::optional<double> meet(const RibFile::Ball& ball, const Vec3& from, const Vec3& ray) {
  const Vec3 to = ball.centre - from;
  const double middle = to.dot(ray) / ray.squaredNorm();
  const double half2 = (ball.radius * ball.radius - (to - middle * ray).squaredNorm()) / ray.squaredNorm();
  if (half2 < 0 || middle - std::sqrt(half2) <= 0) return std::nullopt;
  return middle - std::sqrt(half2);
}

}  // namespace

RibFile read_rib(const fs::path& file) {
  return Reader(file).take();
}

std::vector<double> RibFile::depth(const Frame& frame) const {
  const Matrix world_from_camera = frame.camera_from_world.inverse();
  const Vec3 eye = world_from_camera.col(3).head<3>();
  std::vector<double> depths;
  for (int row = 0; row < frame.height; ++row)
    for (int col = 0; col < frame.width; ++col) {
      const double x = frame.left + (col + 0.5) / frame.width * (frame.right - frame.left);
      const double y = frame.top - (row + 0.5) / frame.height * (frame.top - frame.bottom);
      const Vec3 ray =
          world_from_camera.topLeftCorner<3, 3>() * Vec3(x, y, 1);  // z = 1: depth is the parameter
      double nearest = std::numeric_limits<double>::infinity();
      for (const Polygon& polygon : polygons)
        if (const auto at = meet(polygon, eye, ray)) nearest = std::min(nearest, *at);
      for (const Ball& ball : balls)
        if (const auto at = meet(ball, eye, ray)) nearest = std::min(nearest, *at);
      depths.push_back(nearest);
    }
  return depths;
}

}  // namespace hybrid::testing
