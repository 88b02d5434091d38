// Counts its lives in EEPROM and asks for a reset until it has had three.
#include <Arduino.h>
#include <avr/eeprom.h>

void setup() {
  while (!Serial) {
  }
  uint8_t lives = eeprom_read_byte((uint8_t *)0);
  Serial.print("found ");
  Serial.println(lives);
  if (lives == 0xFF) {
    lives = 0;
    eeprom_write_dword((uint32_t *)4, 0x12345678);
    eeprom_write_word((uint16_t *)9, 0xABCD);  // not aligned
    eeprom_write_block("block", (void *)32, 6);
  }
  uint32_t start = micros();
  eeprom_write_byte((uint8_t *)0, lives + 1);
  Serial.print("write us ");
  Serial.println(micros() - start);
  Serial.print("dword ");
  Serial.println(eeprom_read_dword((uint32_t *)4), HEX);
  Serial.print("word ");
  Serial.println(eeprom_read_word((uint16_t *)9), HEX);
  char text[6];
  eeprom_read_block(text, (void *)32, 6);
  Serial.println(text);
  Serial.print("untouched ");
  Serial.println(eeprom_read_byte((uint8_t *)2047));
  Serial.send_now();
  delay(20);
  if (lives + 1 < 3) SCB_AIRCR = 0x05FA0004;
  Serial.println("three lives");
}

void loop() {}
