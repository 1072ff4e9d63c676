// A table of your own: law.h is generated from extras/law.fis, 5 x 5 rules, by
//   pip install greywhale
//   greywhale export --header law.fis --out law.h
// The sketch compares the law with its test vectors, then prints one row of it.
#include "law.h"

void setup() {
  Serial.begin(115200);
  const uint8_t wrong = law::self_test();
  Serial.println(wrong ? "The self-test failed." : "The self-test passed.");
  for (int32_t e = -law::end; e <= law::end; e += law::end / 8) {
    Serial.println(law::u(static_cast<int16_t>(e), 0));
  }
}

void loop() {}
