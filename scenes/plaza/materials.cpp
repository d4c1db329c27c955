#include "materials.h"

#include <array>
#include <fstream>
#include <stdexcept>

namespace plaza {
namespace {

struct Row {
  const char* name;
  double tile;       // metres
  const char* text;  // MTL statements, separated by ';'
};

// Kd of a textured surface is 1: the texture holds its whole colour.
constexpr Row kTable[] = {
    {"CalcadaOndas", 8.0, "Kd 1 1 1;illum 1;map_Kd calcada_wave.png"},
    {"Calcada", 3.2, "Kd 1 1 1;illum 1;map_Kd calcada_plain.png"},
    {"CalcadaFriso", 1.6, "Kd 1 1 1;illum 1;map_Kd calcada_frieze.png"},
    {"RosaDosVentos", 1, "Kd 1 1 1;illum 1;map_Kd rosette.png"},
    {"Paralelos", 2.6, "Kd 1 1 1;illum 1;map_Kd setts.png"},
    {"Lancil", 2.0, "Kd 0.93 0.92 0.9;illum 1;map_Kd stone.png"},
    {"Carril", 1, "Kd 0.25 0.25 0.26;Ks 0.55 0.55 0.57;Ns 60;Ni 2.5;illum 3"},
    {"Pedra", 2.0, "Kd 1 1 1;illum 1;map_Kd stone.png"},
    {"Cantaria", 2.4, "Kd 1 1 1;illum 1;map_Kd ashlar.png"},
    {"Marmore", 3.0, "Kd 1 1 1;Ks 0.25 0.25 0.25;Ns 40;Ni 1.5;illum 2;map_Kd stone.png"},
    {"Bronze", 1, "Kd 0.16 0.19 0.15;Ks 0.30 0.27 0.18;Ns 24;Ni 1.5;illum 2"},
    {"Latao", 1, "Kd 0.22 0.15 0.05;Ks 0.72 0.55 0.26;Ns 120;Ni 2.5;illum 3"},
    {"Ferro", 1, "Kd 0.055 0.075 0.065;Ks 0.18 0.18 0.18;Ns 30;Ni 1.5;illum 2"},
    {"RebocoOcre", 6.0, "Kd 1 1 1;illum 1;map_Kd plaster_ochre.png"},
    {"RebocoRosa", 6.0, "Kd 1 1 1;illum 1;map_Kd plaster_rose.png"},
    {"RebocoBranco", 6.0, "Kd 1 1 1;illum 1;map_Kd plaster_white.png"},
    {"RebocoVerde", 6.0, "Kd 1 1 1;illum 1;map_Kd plaster_green.png"},
    {"RebocoAzul", 6.0, "Kd 1 1 1;illum 1;map_Kd plaster_blue.png"},
    {"Azulejo", 2.56, "Kd 1 1 1;Ks 0.3 0.3 0.3;Ns 80;Ni 1.5;illum 2;map_Kd azulejo.png"},
    {"Telha", 4.0, "Kd 1 1 1;illum 1;map_Kd roof.png"},
    {"TintaBranca", 1, "Kd 0.72 0.71 0.67;Ks 0.1 0.1 0.1;Ns 20;illum 2"},
    {"TintaVerde", 1, "Kd 0.035 0.13 0.085;Ks 0.15 0.15 0.15;Ns 30;illum 2"},
    {"TintaVermelha", 1, "Kd 0.33 0.05 0.04;Ks 0.15 0.15 0.15;Ns 30;illum 2"},
    {"Porta", 1, "Kd 1 1 1;Ks 0.08 0.08 0.08;Ns 20;illum 2;map_Kd door.png"},
    {"Vidro", 1, "Kd 0.05 0.07 0.08;Ks 1 1 1;Ns 200;Ni 1.1;Tf 0.9 0.9 0.9;illum 4"},
    {"Interior", 1, "Kd 0.17 0.145 0.12;illum 1"},
    {"Soalho", 2.0, "Kd 0.8 0.8 0.8;illum 1;map_Kd boards.png"},
    {"Cortina", 1, "Kd 0.66 0.64 0.58;illum 1"},
    {"CortinaQuente", 1, "Kd 0.50 0.27 0.17;illum 1"},
    {"Espelho", 1, "Kd 0.05 0.05 0.05;Ks 0.82 0.84 0.83;Ns 400;Ni 2.5;illum 3"},
    {"Globo", 1, "Kd 0.80 0.79 0.74;Ks 1 1 1;Ns 200;Ni 1.5;illum 5"},
    {"Agua", 1, "Kd 0.01 0.03 0.03;Ks 1 1 1;Ns 400;Ni 1.33;Tf 0.82 0.92 0.93;illum 7"},
    {"Espuma", 1, "Kd 0.80 0.86 0.88;Ks 0.5 0.5 0.5;Ns 100;illum 2"},
    {"FundoDaFonte", 1.12, "Kd 0.62 0.85 0.88;illum 1;map_Kd azulejo.png"},
    {"Casca", 1.0, "Kd 1 1 1;illum 1;map_Kd bark.png"},
    {"Folhas", 1, "Kd 1 1 1;illum 1;map_Kd leaves.png;map_d leaves.png"},
    {"Flores", 1, "Kd 1 1 1;illum 1;map_Kd blossom.png;map_d blossom.png"},
    {"Terra", 1, "Kd 0.20 0.14 0.09;illum 1"},
    {"Banco", 1.2, "Kd 1 1 1;Ks 0.1 0.1 0.1;Ns 20;illum 2;map_Kd boards.png"},
    {"Toldo", 1.6, "Kd 1 1 1;illum 1;map_Kd awning.png"},
    {"Lona", 1, "Kd 0.74 0.70 0.60;illum 1"},
    {"EletricoAmarelo", 1, "Kd 0.80 0.53 0.03;Ks 0.5 0.5 0.5;Ns 150;Ni 1.5;illum 5"},
    {"EletricoCreme", 1, "Kd 0.62 0.60 0.53;Ks 0.5 0.5 0.5;Ns 150;Ni 1.5;illum 5"},
    {"Borracha", 1, "Kd 0.04 0.04 0.04;illum 1"},
    {"PanoAzul", 1, "Kd 0.09 0.14 0.28;illum 1"},
    {"PanoVermelho", 1, "Kd 0.48 0.08 0.07;illum 1"},
    {"PanoCinza", 1, "Kd 0.25 0.24 0.23;illum 1"},
    {"Lilas", 1, "Kd 0.42 0.28 0.55;illum 1"},
    {"Rosa", 1, "Kd 0.72 0.33 0.42;illum 1"},
    {"Pele", 1, "Kd 0.60 0.40 0.29;illum 1"},
    {"Cabelo", 1, "Kd 0.06 0.04 0.03;illum 1"},
    {"LongeBranco", 1, "Kd 0.62 0.63 0.64;illum 1"},
    {"LongeOcre", 1, "Kd 0.62 0.54 0.45;illum 1"},
    {"LongeTelha", 1, "Kd 0.50 0.34 0.29;illum 1"},
    {"LongeColina", 1, "Kd 0.30 0.37 0.31;illum 1"},
    {"LongePedra", 1, "Kd 0.50 0.455 0.39;illum 1"},
};
static_assert(std::size(kTable) == static_cast<size_t>(Surface::count));

const Row& row(Surface surface) {
  return kTable[static_cast<size_t>(surface)];
}

}  // namespace

double tile_size(Surface surface) {
  return row(surface).tile;
}
const char* material_name(Surface surface) {
  return row(surface).name;
}

void write_materials(const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  out << "# The materials of the plaza.\n";
  for (const Row& r : kTable) {
    out << "\nnewmtl " << r.name << '\n';
    for (const char* c = r.text; *c; ++c) out << (*c == ';' ? '\n' : *c);
    out << '\n';
  }
  out.flush();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace plaza
