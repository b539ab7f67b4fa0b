// Valid scenes made at random from the schema's own table: parts in a tree of joints, and on them items of every kind with
// attributes of every kind; and a trial that runs one with two integrators.
#pragma once

#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/language/schema.hpp"

namespace mbd::test {

// A model of ten steps. Items that the reader or compile refuse are left out again, so what remains is valid; anything but
// an Error comes through. The same seed makes the same model. With an element to aim at it is a small one that has it, most likely.
class Grammar {
 public:
  explicit Grammar(std::uint64_t seed, std::string_view aim = {});

  std::string text() const;  // of the file

  // What it says: "spring", "spring@damping".
  const std::set<std::string>& said() const { return said_; }
  // What was left out again, with the messages.
  const std::vector<std::string>& refused() const { return refused_; }

  // Elements that no scene of these can have, each with the reason.
  struct Never {
    std::string_view element, why;
  };
  static const std::vector<Never>& never();
  // Attributes that none of these has, of others: files, what a trial sets itself.
  static bool leaves_out(std::string_view element, std::string_view attribute);

 private:
  struct Item {
    std::string text;
    std::set<std::string> says;
  };
  struct Part {
    std::string name;
    bool is_beam;
    double at[3];  // of a body its reference point, of a beam its start [m]
    double to[3];  // of a beam
  };

  double uniform(double low, double high);
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }
  bool chance(double p) { return uniform(0.0, 1.0) < p; }
  template <class T>
  const T& one_of(const std::vector<T>& all) {
    return all[below(all.size())];
  }
  std::string vector(double size);
  std::string place_of(const Part& part, std::string& point);

  static void put(Item& item, std::string_view attribute, const std::string& value);
  Item line_of(Part& part);
  std::string stiffness_and_mass(Item& one);

  void choose_steps();
  void add_material();
  void add_section();
  void try_section();
  void add_part();
  void add_others();
  void try_item(const std::string& element);
  bool accepts(const Item& item);

  Item item(const mbd::schema::Element& element, double share);
  std::string along_a_curve(Item& one);
  std::string content(const mbd::schema::Element& element, Item& item, double share);
  std::string value(const mbd::schema::Element& element, const mbd::schema::Attribute& attribute);
  std::string a_beam();
  std::string text_value(std::string_view element, std::string_view attribute);
  std::string word_values(std::string_view element, std::string_view attribute);
  std::string number(const mbd::schema::Attribute& attribute);
  std::string law_of_time(double size);
  std::string quantities();

  std::mt19937_64 random_;
  std::string_view aim_;
  std::vector<Item> items_;
  std::vector<Part> parts_;
  std::vector<std::string> sections_, materials_, layups_, joints_, springs_, functions_, inputs_,
      places_;
  std::vector<std::string> new_names_;    // of the item that is being made
  std::string reduced_;                   // the beam of the last <reduction>
  std::vector<std::string> inner_names_;  // what a controller gives
  bool law_is_table_ = false;             // of a bushing
  int count_ = 0;
  std::string ending_;  // <transient>
  std::set<std::string> said_;
  std::vector<std::string> refused_;
};

// What became of a scene in ten steps of generalized-alpha, and in Radau's of a small tolerance.
struct GrammarTrial {
  std::string refusal;    // an Error before the first step; empty: it began
  std::string failure;    // what ended generalized-alpha early; empty: nothing
  std::string reference;  // the same of Radau
  bool passed = false;    // verdict of the certificate: pass
  bool estimated = false;
  double claimed = 0.0;  // error in time, as the certificate says it
  double error = 0.0;    // the same against Radau, in the same norm

  // What is wrong with it: a certificate that passes a motion that Radau's contradicts. Empty: nothing.
  std::string fault() const;
};

// Throws whatever is not an Error, std::runtime_error for a number in results that is not finite and for a failure
// without a reason.
GrammarTrial try_two_integrators(const std::string& text);

}  // namespace mbd::test
