#include "tests/bench/opencascade_sheet.h"

#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <gp_Pnt.hxx>

namespace spoonbill {
namespace {

struct Knots {
  explicit Knots(const KnotVector& from)
      : values(1, static_cast<int>(from.breakpoints().size())), multiplicities(1, values.Length()) {
    const std::vector<double> breakpoints = from.breakpoints();
    for (int k = 1; k <= values.Length(); ++k) {
      values(k) = breakpoints[static_cast<std::size_t>(k) - 1];
      multiplicities(k) = k == 1 || k == values.Length() ? from.degree() + 1 : 1;
    }
  }
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;
};

}  // namespace

opencascade::handle<Geom_BSplineSurface> opencascade_sheet(const Surface& sheet) {
  TColgp_Array2OfPnt poles(1, sheet.net.rows, 1, sheet.net.columns);
  for (int i = 0; i < sheet.net.rows; ++i) {
    for (int j = 0; j < sheet.net.columns; ++j) {
      const Vector3 point = sheet.net.point(i, j);
      poles(i + 1, j + 1) = gp_Pnt(point.x(), point.y(), point.z());
    }
  }
  const Knots u(sheet.u), v(sheet.v);
  return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities,
                                 sheet.u.degree(), sheet.v.degree());
}

}  // namespace spoonbill
