// SPI at two speeds; pins 11 and 12 are joined by a wire.
#include <Arduino.h>
#include <SPI.h>

void setup() {
  SPI.begin();
  while (!Serial) {
  }
  const uint32_t speeds[] = {1000000, 9000000};
  for (uint32_t speed : speeds) {
    SPI.beginTransaction(SPISettings(speed, MSBFIRST, SPI_MODE0));
    uint32_t start = micros();
    uint8_t a = SPI.transfer(0xA5);
    uint16_t b = SPI.transfer16(0x1234);
    char buffer[] = "a longer transfer through the FIFO";
    SPI.transfer(buffer, sizeof(buffer) - 1);
    uint32_t took = micros() - start;
    SPI.endTransaction();
    Serial.printf("spi %02x %04x [%s] us %lu\n", a, b, buffer, took);
  }
}

void loop() {}
