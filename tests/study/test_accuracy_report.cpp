// A study of accuracy as text, data and pictures: everything it holds is there, honest and well-formed.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/study/accuracy/accuracy_page.hpp"
#include "libmbd/study/accuracy/accuracy_report.hpp"
#include "libmbd/study/accuracy/accuracy_words.hpp"
#include "tests/support/synthetic_study.hpp"

namespace mbd::test::test_accuracy_report {
namespace {

using namespace mbd::study;

std::size_t count(const std::string& text, std::string_view part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

// Rows of cells, as RFC 4180 has them, without lines that begin with #.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  bool begin = true, quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (begin && text[i] == '#') {
      i = text.find('\n', i);
      continue;
    }
    if (begin) rows.push_back({""});
    begin = false;
    std::string& cell = rows.back().back();
    if (quoted) {
      if (text[i] != '"')
        cell += text[i];
      else if (i + 1 < text.size() && text[i + 1] == '"')
        cell += text[i++];
      else
        quoted = false;
    } else if (text[i] == '"') {
      quoted = true;
    } else if (text[i] == ',') {
      rows.back().push_back("");
    } else if (text[i] == '\n') {
      begin = true;
    } else {
      cell += text[i];
    }
  }
  return rows;
}

// What of markup is not well-formed; also all of its tags and attributes.
struct Markup {
  std::string wrong;
  std::vector<std::pair<std::string, std::map<std::string, std::string>>> elements;
};

Markup parse_markup(const std::string& text) {
  Markup markup;
  std::vector<std::string> open;
  const auto check_text = [&](std::string_view part) {
    for (std::size_t at = part.find('&'); at != std::string_view::npos;
         at = part.find('&', at + 1)) {
      bool entity = false;
      for (const std::string_view name : {"&amp;", "&lt;", "&gt;", "&quot;"})
        entity = entity || part.substr(at).starts_with(name);
      if (!entity) markup.wrong += "bare & in " + std::string(part.substr(at, 20)) + "\n";
    }
    for (const char c : part)
      if (c == '>') markup.wrong += "bare > in " + std::string(part.substr(0, 40)) + "\n";
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find('<', at);
    if (open.empty() || open.back() != "style")
      check_text(std::string_view(text).substr(at, begin - at));
    if (begin == std::string::npos) break;
    const std::size_t end = text.find('>', begin);
    if (end == std::string::npos) {
      markup.wrong += "tag not closed\n";
      break;
    }
    std::string_view tag = std::string_view(text).substr(begin + 1, end - begin - 1);
    at = end + 1;
    if (tag.starts_with("!DOCTYPE")) continue;
    if (tag.starts_with("/")) {
      if (open.empty() || open.back() != tag.substr(1))
        markup.wrong += "closed by </" + std::string(tag.substr(1)) + ">\n";
      else
        open.pop_back();
      continue;
    }
    const bool closed = tag.ends_with("/");
    if (closed) tag.remove_suffix(1);
    const std::size_t blank = std::min(tag.find_first_of(" \n"), tag.size());
    const std::string name(tag.substr(0, blank));
    tag.remove_prefix(blank);
    std::map<std::string, std::string> attributes;
    while (tag.find_first_not_of(" \n") != std::string_view::npos) {
      tag.remove_prefix(tag.find_first_not_of(" \n"));
      const std::size_t equals = tag.find("=\"");
      const std::size_t quote =
          equals == std::string_view::npos ? equals : tag.find('"', equals + 2);
      if (quote == std::string_view::npos) {
        markup.wrong += "attribute of " + name + ": " + std::string(tag) + "\n";
        break;
      }
      const std::string value(tag.substr(equals + 2, quote - equals - 2));
      check_text(value);
      if (!attributes.emplace(tag.substr(0, equals), value).second)
        markup.wrong += "attribute twice in " + name + "\n";
      tag.remove_prefix(quote + 1);
    }
    markup.elements.emplace_back(name, attributes);
    if (name == "script") {  // its text is no markup
      at = text.find("</script>", at);
      if (at == std::string::npos) {
        markup.wrong += "script not closed\n";
        break;
      }
    }
    if (!closed && name != "meta") open.push_back(name);
  }
  for (const std::string& name : open) markup.wrong += name + " not closed\n";
  return markup;
}

TEST(AccuracyReport, Numbers) {
  EXPECT_EQ(number_text(1e-4, 1), "1e-4");
  EXPECT_EQ(number_text(1.25e-10), "1.3e-10");
  EXPECT_EQ(number_text(3e-9), "3e-9");
  EXPECT_EQ(number_text(0.0), "0");
  EXPECT_EQ(number_text(0.1, 1), "1e-1");
  EXPECT_EQ(number_text(1.34), "1.3");
  EXPECT_EQ(number_text(134.0), "134");
  EXPECT_EQ(number_text(1.34e7), "1.3e7");
  EXPECT_EQ(number_text(std::nan("")), "-");
  EXPECT_EQ(bound_text(2.4e-9), "3e-9");  // upwards
  EXPECT_EQ(bound_text(3e-9), "3e-9");
  EXPECT_EQ(bound_text(9.7e-9), "1e-8");
  EXPECT_EQ(seconds_text(0.00123), "0.0012");
  EXPECT_EQ(seconds_text(0.9), "0.9");
  EXPECT_EQ(seconds_text(9.97), "10");
  EXPECT_EQ(seconds_text(1234.0), "1234");
}

TEST(AccuracyReport, Sentence) {
  AccuracyStudy study = synthetic_study();
  TrialPoint& point = study.points[5];
  point.text = "order 3, 2/4/2 elements, radau, tolerance 1e-05";
  point.trial.cpu = 0.9;
  EXPECT_EQ(sentence(study, {0, 1e-4, 5}),
            "C.displacement to 1e-4: order 3, 2/4/2 elements, radau, tolerance 1e-05: 0.9 s");
  EXPECT_EQ(sentence(study, {1, 1e-3, 5}),
            "D<&\">.velocity up to time 7.2 s of 10 s to 1e-3: order 3, 2/4/2 elements, radau, "
            "tolerance 1e-05: 0.9 s");
}

TEST(AccuracyReport, Text) {
  const AccuracyStudy study = synthetic_study();
  const std::string text = to_text(study);
  for (const char* part :
       {"four <bar> & \"co\"", "stopped", "failed", "6 not tried", "C.displacement", "E.rotation",
        "there is no reference", "up to time 7.2 s", "note:", "< 3e-9", "(theory 2)", "3e-9 rms",
        "119 s of\n           120 s"})
    EXPECT_TRUE(has(text, part)) << part << "\n" << text;
  for (std::size_t at = 0, end; at < text.size(); at = end + 1) {
    end = text.find('\n', at);
    EXPECT_LE(end - at, 85u) << text.substr(at, end - at);
  }
  EXPECT_FALSE(has(text, "<transient"));
  const std::string with_snippets = to_text(study, synthetic_scene());
  EXPECT_TRUE(has(with_snippets, "<transient")) << with_snippets;
}

TEST(AccuracyReport, ErrorsBelowTheReferenceAreBounds) {
  AccuracyStudy study = synthetic_study();
  const std::size_t last = study.points.size() - 1;
  EXPECT_EQ(rms_text(study, last, 0), "< 3e-9");
  study.points[last].errors[0].below_reference = false;
  EXPECT_EQ(rms_text(study, last, 0), "0");
  study.points[last].errors[0].known = false;
  EXPECT_EQ(rms_text(study, last, 0), "-");
  EXPECT_EQ(rms_text(study, last, 2), "-");
}

TEST(AccuracyReport, CsvCanBeRead) {
  AccuracyStudy study = synthetic_study();
  study.points[0].trial.failure += "\nand, so on";
  const std::string csv = to_csv(study);
  for (const char* part : {"# machine: AMD EPYC", "# reference: Two ways",
                           "# norm: ", "# units: ", "# quantity C.displacement: ", "# note: "})
    EXPECT_TRUE(has(csv, part)) << part;
  const auto rows = parse_csv(csv);
  ASSERT_EQ(rows.size(), study.points.size() + 1);
  std::map<std::string, std::size_t> column;
  for (std::size_t i = 0; i < rows[0].size(); ++i) column[rows[0][i]] = i;
  EXPECT_EQ(column.size(), rows[0].size());  // no name twice
  for (const auto& row : rows) ASSERT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[1][column.at("failure")], study.points[0].trial.failure);
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    const auto& row = rows[i + 1];
    const TrialPoint& point = study.points[i];
    EXPECT_EQ(row[column.at("text")], point.text);
    EXPECT_EQ(row[column.at("state")], point.trial.complete  ? "complete"
                                       : point.trial.stopped ? "stopped"
                                                             : "failed");
    EXPECT_EQ(std::stoi(row[column.at("order")]), *point.setting.order);
    EXPECT_EQ(row[column.at("step")].empty(), !point.setting.step);
    EXPECT_EQ(std::stod(row[column.at("cpu")]), point.trial.cpu);
    EXPECT_EQ(std::stol(row[column.at("residuals")]), point.trial.counters.residuals);
    const std::string& rms = row[column.at("C.displacement.rms")];
    ASSERT_EQ(rms.empty(), !point.errors[0].known);
    if (!rms.empty()) {
      EXPECT_EQ(row[column.at("C.displacement.below_reference")],
                point.errors[0].below_reference ? "1" : "0");
      EXPECT_EQ(std::stod(rms), point.errors[0].rms);
      EXPECT_EQ(row[column.at("C.displacement.front")], on_front(study, i, 0) ? "1" : "0");
    }
    EXPECT_TRUE(row[column.at("E.rotation.rms")].empty());
  }
  EXPECT_TRUE(column.contains("D<&\">.velocity.largest"));
}

TEST(AccuracyReport, JsonHoldsTheStudy) {
  AccuracyStudy study = synthetic_study();
  study.notes.push_back("no UTF-8: \xFF");
  const auto json = nlohmann::json::parse(to_json(study));
  EXPECT_EQ(json["model"], study.model);
  ASSERT_EQ(json["points"].size(), study.points.size());
  EXPECT_EQ(json["quantities"][0]["reference_rms"], synthetic_reference);
  EXPECT_EQ(json["quantities"][1]["until"], 7.2);
  EXPECT_EQ(json["quantities"][0]["front"].size(), study.fronts[0].size());
  EXPECT_EQ(json["points"][0]["state"], "failed");
  EXPECT_FALSE(json["points"][0]["errors"][0].contains("rms"));
  EXPECT_EQ(json["points"][1]["errors"][0]["rms"], study.points[1].errors[0].rms);
  EXPECT_EQ(json["points"].back()["errors"][0]["below_reference"], true);
  EXPECT_EQ(json["points"][1]["setting"]["order"], 2);
  EXPECT_EQ(json["points"][1]["setting"]["step"], 1e-2);
  EXPECT_FALSE(json["points"][1]["setting"].contains("tolerance"));
  ASSERT_EQ(json["advice"].size(), study.advice.size());
  EXPECT_EQ(json["advice"][0]["sentence"], sentence(study, study.advice[0]));
  EXPECT_EQ(json["fits"][0]["theory"], 2.0);
  EXPECT_EQ(json["reference"]["ways"].size(), 4u);
  EXPECT_EQ(json["untried"], 6);
}

TEST(AccuracyReport, MarkdownIsASection) {
  const AccuracyStudy study = synthetic_study();
  const std::string text = to_markdown(study);
  EXPECT_TRUE(has(text, "- C.displacement to 1e-4: ")) << text;
  EXPECT_TRUE(has(text, "D&lt;&amp;&quot;&gt;.velocity up to time 7.2 s of 10 s to ")) << text;
  EXPECT_TRUE(has(text, "- E.rotation: no accuracy can be told")) << text;
  EXPECT_TRUE(has(text, "generalized\\_alpha")) << text;
  EXPECT_TRUE(has(text, "Note: Kinetic energy &lt;rings&gt;")) << text;
  EXPECT_TRUE(has(text, "in 119 s on AMD EPYC 7B13, 2 cores. Reference: ")) << text;
  EXPECT_FALSE(has("\n" + text, "\n#"));
}

TEST(AccuracyReport, FamiliesRunFromCoarseToFine) {
  const AccuracyStudy study = synthetic_study();
  const std::vector<Family> families = families_of(study);
  ASSERT_EQ(families.size(), 18u);  // orders, meshes, methods
  std::set<std::string> labels;
  std::set<std::size_t> points;
  for (const Family& family : families) {
    labels.insert(family.label);
    for (std::size_t i = 0; i < family.points.size(); ++i) {
      points.insert(family.points[i]);
      if (i == 0) continue;
      EXPECT_LT(*number_of(study.points[family.points[i]].setting, family.along),
                *number_of(study.points[family.points[i - 1]].setting, family.along));
    }
  }
  EXPECT_EQ(labels.size(), families.size());
  EXPECT_EQ(points.size(), study.points.size());
  EXPECT_TRUE(labels.contains("order 3, 1 element, radau")) << *labels.begin();

  // Over elements: each order and method, at the finest step or tolerance that has errors.
  const std::vector<Family> over = families_over(study, Knob::elements, 0);
  ASSERT_EQ(over.size(), 6u);
  for (const Family& family : over) {
    ASSERT_EQ(family.points.size(), 3u) << family.label;
    const Setting& s = study.points[family.points[0]].setting;
    // the smallest step was stopped on the finest mesh: the next has more errors
    EXPECT_EQ(s.step ? *s.step : *s.tolerance, s.step ? 3e-4 : 1e-9);
    EXPECT_EQ(*study.points[family.points[2]].setting.elements, 4);
  }
}

TEST(AccuracyReport, PicturesShowWhatIsKnown) {
  AccuracyStudy study = synthetic_study();
  const std::string svg = accuracy_svg(study);
  EXPECT_EQ(parse_markup(svg).wrong, "");
  std::size_t drawn = 0, below = 0;
  for (const TrialPoint& point : study.points)
    for (const QuantityError& e : point.errors) {
      drawn += e.known ? 1 : 0;
      below += e.known && e.below_reference ? 1 : 0;
    }
  ASSERT_GT(below, 1u);
  EXPECT_EQ(count(svg, "class=\"m hollow\""), below);
  EXPECT_EQ(count(svg, "class=\"level\""), 2u * 2);  // each also in a legend
  EXPECT_EQ(count(svg, "cheapest for its error"), 2u);
  EXPECT_EQ(count(svg, "other settings"), 2u);
  const std::size_t entries = count(svg, "class=\"m\"") + below - drawn;  // markers of the legend
  EXPECT_GE(entries, 4u);
  EXPECT_LE(entries, 14u);
  EXPECT_FALSE(has(svg, "E.rotation"));
  EXPECT_FALSE(has(svg, "nan"));
  EXPECT_FALSE(has(svg, "D<"));

  const std::string knobs = knobs_svg(study);
  EXPECT_EQ(parse_markup(knobs).wrong, "");
  for (const char* part : {"over step", "over tolerance", "over elements", "over order", "1.89 (2)",
                           "0.99 (1)", "−4.00 (−4)"})
    EXPECT_EQ(has(knobs, part), true) << part;
  EXPECT_EQ(count(knobs, "class=\"slope\""), 2u * (1 + 1 + 3));

  // What is seen changes with what is known.
  study.fronts[0].pop_back();
  EXPECT_TRUE(accuracy_svg(study) != svg);
  study = synthetic_study();
  study.points[20].errors[0].below_reference = !study.points[20].errors[0].below_reference;
  EXPECT_TRUE(accuracy_svg(study) != svg);
  study = synthetic_study();
  study.points[20].errors[0].known = false;
  EXPECT_TRUE(accuracy_svg(study) != svg);
  study = synthetic_study();
  study.quantities[0].reference_rms *= 2;
  EXPECT_TRUE(accuracy_svg(study) != svg);
  study = synthetic_study();
  study.points[20].trial.cpu *= 2;
  EXPECT_TRUE(accuracy_svg(study) != svg);
  study = synthetic_study();
  study.fits[0].slope *= 1.5;
  EXPECT_TRUE(knobs_svg(study) != knobs);
}

// What a page is filled with, in the browser.
nlohmann::json data_of(const std::string& page) {
  constexpr std::string_view begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t at = page.find(begin);
  if (at == std::string::npos) return {};
  const std::size_t from = at + begin.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

// What it shows when it is filled is looked at in a browser (AccuracyPageSlow). Tried, and killed: `<` of data as it is.
TEST(AccuracyReport, PageIsATemplateAndItsDataAndNeedsNothing) {
  const std::string page = accuracy_page(synthetic_study(), synthetic_scene());
  const Markup markup = parse_markup(page);
  EXPECT_EQ(markup.wrong, "");
  std::set<std::string> ids;
  for (const auto& [name, attributes] : markup.elements) {
    EXPECT_NE(name, "link");
    EXPECT_NE(name, "img");
    for (const auto& [key, value] : attributes) {
      EXPECT_NE(key, "src");
      EXPECT_NE(key, "href");
      EXPECT_FALSE(key.starts_with("on")) << key;
      if (key == "id") {
        EXPECT_TRUE(ids.insert(value).second) << value << " twice";
      }
    }
  }
  EXPECT_EQ(count(page, "http:"), count(page, "xmlns=\\\"http://www.w3.org/2000/svg\\\""));
  EXPECT_EQ(count(page, "https:"), 0U);
  EXPECT_EQ(count(page, "url("), count(page, "url(#"));
  EXPECT_FALSE(has(page, "@import"));
  for (const char* part : {"four &lt;bar&gt; &amp; &quot;co&quot;", "name=\"viewport\"",
                           "@media print", "<details>", "Content-Security-Policy"})
    EXPECT_TRUE(has(page, part)) << part;
  const std::size_t at = page.find("id=\"data\">") + 10;
  EXPECT_EQ(page.find('<', at), page.find("</script>", at));
  const nlohmann::json data = data_of(page);
  const std::string all = data.dump();
  for (const char* part :
       {R"(D<&\">.velocity)", "< 3e-9", "<transient", "bar<2>", "stopped after 12 s",
        "6 settings were not tried", "up to time 7.2 s of 10 s", "<rings>", "AMD EPYC",
        "--budget 120", "Two ways to the same motion"})
    EXPECT_TRUE(has(all, part)) << part;
  for (const char* pictures : {"cost", "knobs"})
    for (const nlohmann::json& picture : data.at(pictures))
      EXPECT_EQ(parse_markup(picture.get<std::string>()).wrong, "") << pictures;
}

TEST(AccuracyReport, PageMarksTheFront) {
  AccuracyStudy study = synthetic_study();
  const nlohmann::json runs = data_of(accuracy_page(study, synthetic_scene())).at("runs");
  ASSERT_EQ(runs.size(), study.points.size());
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    EXPECT_EQ(runs[i].at("run"), i + 1);
    EXPECT_EQ(runs[i].at("front"), on_front(study, i, 0) || on_front(study, i, 1)) << runs[i];
    for (const std::size_t q : {0U, 1U})
      EXPECT_EQ(runs[i].at("errors").at(q).at("front"), on_front(study, i, q)) << runs[i];
  }
  study.fronts = {{}, {}, {}};
  for (const nlohmann::json& run : data_of(accuracy_page(study, synthetic_scene())).at("runs"))
    EXPECT_FALSE(run.at("front"));
}

// One setting, no errors, nothing at all: pages that stand, and say so.
TEST(AccuracyReport, EmptyStudies) {
  AccuracyStudy study;
  const auto check = [&] {
    EXPECT_EQ(parse_markup(accuracy_page(study, synthetic_scene())).wrong, "");
    EXPECT_EQ(parse_markup(accuracy_svg(study)).wrong, "");
    EXPECT_EQ(parse_markup(knobs_svg(study)).wrong, "");
    EXPECT_FALSE(to_text(study).empty());
    EXPECT_FALSE(to_csv(study).empty());
    EXPECT_NO_THROW(nlohmann::json::parse(to_json(study)));
    EXPECT_FALSE(to_markdown(study).empty());
  };
  check();
  study = synthetic_study();
  study.points.resize(1);
  study.fronts.clear();
  study.fits.clear();
  study.advice.clear();
  check();
  EXPECT_TRUE(has(to_text(study), "1 run: 0 complete, 1 failed"));
  study = synthetic_study();
  for (TrialPoint& point : study.points) point.errors.clear();
  study.fronts.clear();
  study.fits.clear();
  study.advice.clear();
  check();
}

}  // namespace
}  // namespace mbd::test::test_accuracy_report
