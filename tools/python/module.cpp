// mbd._mbd: the part of the package that is C++. What is public is in mbd/*.py.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "libmbd/language/manual.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/report.hpp"
#include "tools/mbd/view_assets.hpp"
#include "tools/python/errors.hpp"
#include "tools/python/model.hpp"

namespace mbd::python {
namespace {

py::dict attribute_of(const schema::Attribute& a) {
  py::dict one;
  one["name"] = std::string(a.name);
  one["value"] = manual::value_of(a);
  one["unit"] = std::string(a.unit);
  one["default"] = std::string(a.fallback);
  one["doc"] = std::string(a.doc);
  one["is_text"] = a.kind == schema::Kind::text;
  return one;
}

// The table that reader, manual and grammar have too.
py::list elements() {
  py::list all;
  for (const schema::Element& element : schema::elements()) {
    py::dict one;
    one["name"] = std::string(element.name);
    one["parents"] = std::string(element.parents);
    one["doc"] = std::string(element.doc);
    one["content"] = std::string(element.content);
    one["page"] = to_text(element);
    py::list attributes;
    for (const schema::Attribute& a : element.attributes) attributes.append(attribute_of(a));
    one["attributes"] = attributes;
    all.append(one);
  }
  return all;
}

}  // namespace
}  // namespace mbd::python

PYBIND11_MODULE(_mbd, module) {
  using namespace mbd::python;
  module.doc() = "The part of mbd that is C++.";
  translate_errors();
  bind_model(module);
  bind_stepper(module);
  bind_studies(module);
  bind_sweep(module);
  module.def("elements", &elements);
  module.attr("version") = std::string(mbd::version());
  module.attr("library_file") = mbd::library_file();
  module.attr("has_pages") = !mbd::view_assets().html.empty();
}
