#include "ngs/core/folded_name.h"

#include <cstdint>

namespace ngs {
namespace {

/// The letters that a combining mark composes, each followed by its base (Unicode 15, canonical decompositions).
struct Composed {
  char16_t mark;
  std::u16string_view pairs;
};
// clang-format off
constexpr Composed kComposed[] = {
    {u'\u0300', u"ÀAÈEÌIÒOÙUàaèeìiòoùuǛÜǜüǸNǹnЀЕЍИѐеѝиḔĒḕēṐŌṑōẀWẁwẦÂầâẰĂằăỀÊềêỒÔồôỜƠờơỪƯừưỲYỳy"},
    {u'\u0301', u"ÁAÉEÍIÓOÚUÝYáaéeíióoúuýyĆCćcĹLĺlŃNńnŔRŕrŚSśsŹZźzǗÜǘüǴGǵgǺÅǻåǼÆǽæǾØǿøΆΑΈΕΉΗΊΙΌΟΎΥ"
               u"ΏΩΐϊάαέεήηίιΰϋόούυώωЃГЌКѓгќкḈÇḉçḖĒḗēḮÏḯïḰKḱkḾMḿmṌÕṍõṒŌṓōṔPṕpṸŨṹũẂWẃwẤÂấâẮĂắăẾÊếê"
               u"ỐÔốôỚƠớơỨƯứư"},
    {u'\u0302', u"ÂAÊEÎIÔOÛUâaêeîiôoûuĈCĉcĜGĝgĤHĥhĴJĵjŜSŝsŴWŵwŶYŷyẐZẑzẬẠậạỆẸệẹỘỌộọ"},
    {u'\u0303', u"ÃAÑNÕOãañnõoĨIĩiŨUũuṼVṽvẪÂẫâẴĂẵăẼEẽeỄÊễêỖÔỗôỠƠỡơỮƯữưỸYỹy"},
    {u'\u0304', u"ĀAāaĒEēeĪIīiŌOōoŪUūuǕÜǖüǞÄǟäǠȦǡȧǢÆǣæǬǪǭǫȪÖȫöȬÕȭõȰȮȱȯȲYȳyӢИӣиӮУӯуḠGḡgḸḶḹḷṜṚṝṛ"},
    {u'\u0306', u"ĂAăaĔEĕeĞGğgĬIĭiŎOŏoŬUŭuЎУЙИйиўуӁЖӂжӐАӑаӖЕӗеḜȨḝȩẶẠặạ"},
    {u'\u0307', u"ĊCċcĖEėeĠGġgİIŻZżzȦAȧaȮOȯoḂBḃbḊDḋdḞFḟfḢHḣhṀMṁmṄNṅnṖPṗpṘRṙrṠSṡsṤŚṥśṦŠṧšṨṢṩṣṪTṫtẆW"
               u"ẇwẊXẋxẎYẏyẛſ"},
    {u'\u0308', u"ÄAËEÏIÖOÜUäaëeïiöoüuÿyŸYΪΙΫΥϊιϋυЁЕЇІёеїіӒАӓаӚӘӛәӜЖӝжӞЗӟзӤИӥиӦОӧоӪӨӫөӬЭӭэӰУӱуӴЧӵч"
               u"ӸЫӹыḦHḧhṎÕṏõṺŪṻūẄWẅwẌXẍxẗt"},
    {u'\u0309', u"ẢAảaẨÂẩâẲĂẳăẺEẻeỂÊểêỈIỉiỎOỏoỔÔổôỞƠởơỦUủuỬƯửưỶYỷy"},
    {u'\u030A', u"ÅAåaŮUůuẘwẙy"},
    {u'\u030B', u"ŐOőoŰUűuӲУӳу"},
    {u'\u030C', u"ČCčcĎDďdĚEěeĽLľlŇNňnŘRřrŠSšsŤTťtŽZžzǍAǎaǏIǐiǑOǒoǓUǔuǙÜǚüǦGǧgǨKǩkǮƷǯʒǰjȞHȟh"},
    {u'\u030F', u"ȀAȁaȄEȅeȈIȉiȌOȍoȐRȑrȔUȕuѶѴѷѵ"},
    {u'\u0311', u"ȂAȃaȆEȇeȊIȋiȎOȏoȒRȓrȖUȗu"},
    {u'\u031B', u"ƠOơoƯUưu"},
    {u'\u0323', u"ḄBḅbḌDḍdḤHḥhḲKḳkḶLḷlṂMṃmṆNṇnṚRṛrṢSṣsṬTṭtṾVṿvẈWẉwẒZẓzẠAạaẸEẹeỊIịiỌOọoỢƠợơỤUụuỰƯựư"
               u"ỴYỵy"},
    {u'\u0324', u"ṲUṳu"},
    {u'\u0325', u"ḀAḁa"},
    {u'\u0326', u"ȘSșsȚTțt"},
    {u'\u0327', u"ÇCçcĢGģgĶKķkĻLļlŅNņnŖRŗrŞSşsŢTţtȨEȩeḐDḑdḨHḩh"},
    {u'\u0328', u"ĄAąaĘEęeĮIįiŲUųuǪOǫo"},
    {u'\u032D', u"ḒDḓdḘEḙeḼLḽlṊNṋnṰTṱtṶUṷu"},
    {u'\u032E', u"ḪHḫh"},
    {u'\u0330', u"ḚEḛeḬIḭiṴUṵu"},
    {u'\u0331', u"ḆBḇbḎDḏdḴKḵkḺLḻlṈNṉnṞRṟrṮTṯtẔZẕzẖh"},
    {u'\u3099', u"がかぎきぐくげけごこざさじしずすぜせぞそだたぢちづつでてどとばはびひぶふべへぼほゔうゞゝガカギキグクゲケゴコザサジシズスゼセゾソダタヂチヅツデテドトバハビヒブフ"
               u"ベヘボホヴウヷワヸヰヹヱヺヲヾヽ"},
    {u'\u309A', u"ぱはぴひぷふぺへぽほパハピヒプフペヘポホ"},
};
// clang-format on

void append_utf8(std::uint32_t c, std::string& out) {
  if (c < 0x80)
    out += char(c);
  else if (c < 0x800)
    out += {char(0xC0 | c >> 6), char(0x80 | (c & 0x3F))};
  else
    out += {char(0xE0 | c >> 12), char(0x80 | (c >> 6 & 0x3F)), char(0x80 | (c & 0x3F))};
}

bool append_hangul(std::uint32_t c, std::string& out) {
  constexpr std::uint32_t kFirst = 0xAC00, kCount = 11172, kVowels = 21, kTails = 28;
  if (c < kFirst || c >= kFirst + kCount) return false;
  const std::uint32_t index = c - kFirst;
  append_utf8(0x1100 + index / (kVowels * kTails), out);
  append_utf8(0x1161 + index % (kVowels * kTails) / kTails, out);
  if (index % kTails != 0) append_utf8(0x11A7 + index % kTails, out);
  return true;
}

void append_decomposed(std::uint32_t c, std::string& out) {
  if (c < 0x80) return append_utf8(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c, out);
  if (append_hangul(c, out)) return;
  for (const Composed& of : kComposed)
    for (std::size_t i = 0; i < of.pairs.size(); i += 2) {
      if (of.pairs[i] != c) continue;
      append_decomposed(of.pairs[i + 1], out);
      return append_utf8(of.mark, out);
    }
  append_utf8(c, out);
}

/// Bytes of the character at name[at] if it is UTF-8 of one to three bytes; 0: other bytes.
std::size_t length_at(std::string_view name, std::size_t at) {
  const auto byte = [&](std::size_t k) { return at + k < name.size() ? std::uint8_t(name[at + k]) : std::uint8_t(0); };
  const auto follows = [&](std::size_t k) { return (byte(k) & 0xC0) == 0x80; };
  if (byte(0) < 0x80) return 1;
  if ((byte(0) & 0xE0) == 0xC0) return follows(1) ? 2 : 0;
  return (byte(0) & 0xF0) == 0xE0 && follows(1) && follows(2) ? 3 : 0;
}

}  // namespace

std::string folded_name(std::string_view name) {
  std::string out;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t length = length_at(name, at);
    if (length == 0) {
      out += name[at++];
      continue;
    }
    std::uint32_t c = std::uint8_t(name[at]);
    if (length > 1) c &= length == 2 ? 0x1F : 0x0F;
    for (std::size_t k = 1; k < length; ++k) c = c << 6 | (std::uint8_t(name[at + k]) & 0x3F);
    append_decomposed(c, out);
    at += length;
  }
  return out;
}

std::string lower_case(std::string_view name) {
  std::string lower(name);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return lower;
}

}  // namespace ngs
