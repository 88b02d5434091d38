// Scans the bus, then reads the sensor's name at both speeds with a repeated start.
#include <Arduino.h>
#include <Wire.h>

static int whoAmI() {
  Wire.beginTransmission(0x68);
  Wire.write(0x75);
  if (Wire.endTransmission(false) != 0) return -1;
  if (Wire.requestFrom(0x68, 1) != 1) return -2;
  return Wire.read();
}

void setup() {
  Wire.begin();
  while (!Serial) {
  }
  int found = 0;
  for (uint8_t address = 1; address < 127; address++) {
    Wire.beginTransmission(address);
    if (Wire.endTransmission() == 0) {
      Serial.print("device at 0x");
      Serial.println(address, HEX);
      found++;
    }
  }
  Serial.print("devices ");
  Serial.println(found);
  const uint32_t speeds[] = {100000, 400000};
  for (uint32_t speed : speeds) {
    Wire.setClock(speed);
    uint32_t start = micros();
    int name = whoAmI();
    uint32_t took = micros() - start;
    Serial.print("who ");
    Serial.print(name, HEX);
    Serial.print(" us ");
    Serial.println(took);
  }
  // Wake it up and read a burst of fourteen bytes.
  Wire.beginTransmission(0x68);
  Wire.write(0x6B);
  Wire.write(0x01);
  Wire.endTransmission();
  delay(50);
  Wire.beginTransmission(0x68);
  Wire.write(0x3B);
  Wire.endTransmission(false);
  Wire.requestFrom(0x68, 14, true);
  Serial.print("burst ");
  Serial.println(Wire.available());
  int16_t axes[7];
  for (auto &axis : axes) {
    axis = Wire.read() << 8;
    axis |= Wire.read();
  }
  Serial.printf("accel %d %d %d\n", axes[0], axes[1], axes[2]);
  Wire.beginTransmission(0x50);
  Wire.write(0);
  Serial.print("nobody ");
  Serial.println(Wire.endTransmission());
}

void loop() {}
