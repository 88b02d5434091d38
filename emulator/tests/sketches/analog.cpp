// Reads every analog input at several resolutions, the internal channels, and puts out a voltage.
#include <Arduino.h>

void setup() {
  while (!Serial) {
  }
  Serial.print("ten bits");
  const int front[] = {A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13};
  for (int pin : front) {
    Serial.print(' ');
    Serial.print(analogRead(pin));
  }
  Serial.println();
  Serial.print("back");
  const int back[] = {A15, A16, A17, A18, A19, A20};
  for (int pin : back) {
    Serial.print(' ');
    Serial.print(analogRead(pin));
  }
  Serial.println();
  const int resolutions[] = {8, 12, 16};
  for (int bits : resolutions) {
    analogReadResolution(bits);
    analogRead(A0);  // waits for the calibration
    uint32_t start = micros();
    int value = analogRead(A0);
    uint32_t took = micros() - start;
    Serial.printf("bits %d %d us %lu\n", bits, value, took);
  }
  analogReadResolution(12);
  analogReadAveraging(32);
  Serial.printf("temperature %d\n", analogRead(38));
  Serial.printf("reference %d\n", analogRead(39));
  analogWriteResolution(12);
  analogWrite(A14, 2047);
  Serial.printf("dac %d\n", analogRead(40));
  analogReference(INTERNAL);
  delay(50);
  Serial.printf("internal %d\n", analogRead(A1));
}

void loop() {}
